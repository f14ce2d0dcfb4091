#include "modules/scheduler/scheduler_params.h"

#include <fmt/format.h>

namespace rtusim {

void scheduler_stats::describe(config::report& r) const {
  r.number("jobs", jobs.count, "jobs", "jobs handed to a core");
  jobs.describe(r, "cycles in which a job is offered and no core takes it", "the same of the job that waits longest");
}

void scheduler_params::describe(config::section& s) {
  const auto meanings = scheduler_policies::meanings();
  s.choice("policy", select, scheduler_policies::names(),
           fmt::format("how a job finds its core: {}, or {}", fmt::join(meanings.begin(), meanings.end() - 1, ", "), meanings.back()));
}

}  // namespace rtusim
