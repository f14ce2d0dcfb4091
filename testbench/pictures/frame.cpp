#include "testbench/pictures/frame.h"

#include <cmath>

namespace rtusim {

frame::frame(const raster& p, unsigned fraction_bits, bool surfaces)
    : width_(p.width),
      height_(p.height),
      unit_(std::ldexp(1.0, -static_cast<int>(fraction_bits))),
      pixels_(std::size_t{p.width} * p.height),
      surfaces_(surfaces ? pixels_.size() : 0) {}

void frame::leave_out_all_but(const std::vector<job_packet>& jobs) {
  if (jobs.size() == pixels_.size()) return;
  for (pixel& p : pixels_) p.arrived = true;
  for (const job_packet& j : jobs) pixels_[j.pixel()].arrived = false;
  arrived_ = pixels_.size() - jobs.size();
}

}  // namespace rtusim
