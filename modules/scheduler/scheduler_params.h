#pragma once

#include <algorithm>
#include <cstdint>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/scheduler/policies/policies.h"

namespace rtusim {

struct scheduler_params {
  unsigned select = policy_index<cyclic_first_available>;  ///< which of `scheduler_policies`

  void describe(config::section& s);
};

struct scheduler_stats {
  std::uint64_t jobs = 0;
  std::uint64_t wait_cycles = 0;  ///< sum over the jobs
  std::uint64_t most_wait_cycles = 0;

  /// A job was offered for so many cycles before the one in which a core took it.
  void count(std::uint64_t waited_cycles) {
    ++jobs;
    wait_cycles += waited_cycles;
    most_wait_cycles = std::max(most_wait_cycles, waited_cycles);
  }
  void describe(config::report& r) const;
};

}  // namespace rtusim
