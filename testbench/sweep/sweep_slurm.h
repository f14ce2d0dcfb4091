#pragma once

#include <cstddef>
#include <filesystem>

#include "testbench/sweep/results_folder.h"

namespace rtusim {

/// Lets a job array of Slurm run so many tasks, each a share of a sweep file's points, and waits for its end; what it came to is seen from
/// the folder. Its script is `slurm.sh` there, what sbatch says `slurm.log`, what the tasks say `slurm-I.log`.
/// Errors: input_error where there is no Slurm, or one that takes no jobs; simulation_error when this is interrupted: the array goes on.
void run_slurm_array(const std::filesystem::path& sweep_file, const results_folder& folder, std::size_t tasks);

}  // namespace rtusim
