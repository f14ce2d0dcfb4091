#include "testbench/frame.h"

#include <cmath>

namespace rtusim {

void frame::params::describe(config::section& s) {
  s.number("width", width, {1, most_pixels_a_side}, "pixels", "columns of the picture; one ray a pixel");
  s.number("height", height, {1, most_pixels_a_side}, "pixels", "rows of the picture");
}

frame::frame(const params& p, unsigned fraction_bits)
    : width_(p.width),
      height_(p.height),
      unit_(std::ldexp(1.0, -static_cast<int>(fraction_bits))),
      pixels_(std::size_t{p.width} * p.height) {}

}  // namespace rtusim
