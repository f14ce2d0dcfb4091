#pragma once

#include <cstdint>

#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"

namespace rtusim {

/// A ray as the triangle cores see it.
struct triangle_job : core_job {
  quantised_ray ray;  ///< from where it enters the box, or from its origin within
};

}  // namespace rtusim
