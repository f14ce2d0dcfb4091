#pragma once

#include <cstdint>
#include <vector>

#include "testbench/bench/simulation.h"
#include "testbench/kinds/loaded_model.h"
#include "testbench/run/run_setup.h"

namespace rtusim {

/// About how many bytes the waveform of a window will have, from the cycles that cores work on a sample of the jobs: within a factor of
/// two. 0 for one that is small whatever the jobs are.
std::uint64_t estimated_bytes(const waveform_window& window, const run_setup& s, const loaded_model& model,
                              const std::vector<job_packet>& jobs);

/// Sees that a waveform which nobody asked to be large will not be.
/// Errors: input_error, with the size, when a file would get more than 500 MB.
void check_size(const waveform_window& window, const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs);

}  // namespace rtusim
