#pragma once

namespace rtusim {

/// A unit's contract of timing: what it promises of whatever passes through it, from an input to an output.
struct unit_timing {
  unsigned latency_cycles = 0;   ///< from the cycle in which something enters to the first in which what comes of it may leave
  unsigned interval_cycles = 1;  ///< between two cycles in which something enters, at the least
  bool beside_cost = false;      ///< both count beside the cost of what enters
  unsigned capacity = 0;         ///< how much it takes, of one input, while nothing leaves
  bool valid_passes = false;     ///< its output's valid follows from its input's within the cycle
  bool ready_passes = false;     ///< its input's ready follows from its output's within the cycle
};

}  // namespace rtusim
