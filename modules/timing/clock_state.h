#pragma once

#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

class channel_base;

/// What units and channels see of their clock at every turn.
struct clock_state {
  cycle now = never;  ///< the edge being done
  cycle next = 0;     ///< the edge to be done next: all before it are done
  std::vector<std::vector<channel_base*>> dirty;  ///< channels whose offers changed, by rank
};

}  // namespace rtusim
