#pragma once

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/config/wait_stats.h"
#include "modules/scheduler/policies/policies.h"

namespace rtusim {

struct scheduler_params {
  unsigned select = policy_index<cyclic_first_available>;  ///< which of `scheduler_policies`

  void describe(config::section& s);
};

struct scheduler_stats {
  wait_stats jobs;  ///< cycles in which each was offered before the one in which a core took it

  void describe(config::report& r) const;
};

}  // namespace rtusim
