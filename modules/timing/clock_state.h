#pragma once

#include "modules/timing/calendar.h"
#include "modules/timing/offer.h"

namespace rtusim {

/// What units and channels see of their clock at every turn.
struct clock_state {
  cycle now = never - 1;  ///< the edge being done; before the first, one that no run reaches
  cycle next = 0;         ///< the edge to be done next: all before it are done
  cycle last_transfer = 0;
  cycle watchdog = 1'000'000;  ///< a run without a transfer in so many cycles ends
  calendar bookings;
};

}  // namespace rtusim
