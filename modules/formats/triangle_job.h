#pragma once

#include <cstdint>

#include "modules/formats/quantisation.h"

namespace rtusim {

/// A ray as the triangle cores see it.
struct triangle_job {
  std::uint32_t job_word = 0;
  std::uint32_t sequence = 0;  ///< not in the hardware: the how-manieth job of the run, for the scoreboard
  quantised_ray ray;           ///< from where it enters the box, or from its origin within
};

}  // namespace rtusim
