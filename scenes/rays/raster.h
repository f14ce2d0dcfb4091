#pragma once

#include "modules/config/section.h"

namespace rtusim {

/// The pixels of a picture, a ray each: pixel y * width + x, row 0 on top.
struct raster {
  /// Every pixel of the largest one has a job id of its own.
  static constexpr unsigned most_pixels_a_side = 16384;

  unsigned width = 1280;
  unsigned height = 720;

  void describe(config::section& s);
};

}  // namespace rtusim
