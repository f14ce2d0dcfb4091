#pragma once

#include <string>
#include <vector>

#include "testbench/sweep/results_folder.h"
#include "testbench/sweep/sweep_identity.h"
#include "testbench/sweep/sweep_plan.h"

namespace rtusim {

/// Why each point that has no result has none, in the order of the plan.
std::vector<std::string> failures_of(const std::vector<sweep_task>& tasks, const results_folder& folder);

/// Puts `results.csv`, a row a point in the order of the plan, and `results.json`, with units and meanings, into the folder. They depend on
/// the results alone. `units`: the table has a second header row, with each column's unit.
/// Returns what `failures_of` does.
/// Errors: input_error for a figure that no point has, or when they can't be written.
std::vector<std::string> gather(const sweep_plan& plan, const std::vector<sweep_task>& tasks, const results_folder& folder, bool units);

/// Lines for a person: how many points failed, for which reasons, the most frequent first.
std::string failure_text(const std::vector<std::string>& reasons);

}  // namespace rtusim
