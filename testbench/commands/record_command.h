#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace rtusim {

/// What `rtusim rerun` was asked for.
struct rerun_options {
  std::filesystem::path record;
  std::filesystem::path statistics;  ///< the new statistics file; empty: none
  bool quiet = false;
};

/// Runs what a statistics file records once more and holds the new figures against the old ones.
/// Errors: input_error for a file that is no statistics file, or whose model or jobs are not what they were; simulation_error when a
/// figure differs.
void rerun(const rerun_options& o);

/// What differs between two statistics files, as a table: parameters, inputs, figures with their change. What the simulator itself spent
/// is left out. Empty when nothing differs.
/// Errors: input_error for a file that is none.
std::string difference_text(const std::filesystem::path& a, const std::filesystem::path& b);

/// Add the commands `rerun` and `diff` to the program.
void add_rerun(CLI::App& program);
void add_diff(CLI::App& program);

}  // namespace rtusim
