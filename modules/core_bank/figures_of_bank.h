#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modules/config/unit_figures.h"
#include "modules/result_manager/result_manager_params.h"
#include "modules/scheduler/scheduler_params.h"

namespace rtusim {

/// What the units of a bank have counted, in their order, where there are no units.
template <class Jobs, class Core>
std::vector<named_figures> figures_of_bank(const Jobs& jobs, const scheduler_stats& dispatches, const std::vector<Core>& cores,
                                           const result_manager_stats& results) {
  std::vector<named_figures> all{{"job_manager", as_figures(jobs)}, {"scheduler", as_figures(dispatches)}};
  for (std::size_t i = 0; i < cores.size(); ++i) all.push_back({"core_" + std::to_string(i), as_figures(cores[i])});
  all.push_back({"result_manager", as_figures(results)});
  return all;
}

}  // namespace rtusim
