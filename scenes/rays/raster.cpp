#include "scenes/rays/raster.h"

namespace rtusim {

void raster::describe(config::section& s) {
  s.number("width", width, {1, most_pixels_a_side}, "pixels", "columns of the picture; one ray a pixel");
  s.number("height", height, {1, most_pixels_a_side}, "pixels", "rows of the picture");
}

}  // namespace rtusim
