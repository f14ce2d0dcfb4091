#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "modules/timing/offer.h"
#include "testbench/run/procedure.h"

namespace CLI {
class App;
}

namespace rtusim {

/// What `rtusim run` was asked for. Empty paths: not asked.
struct run_options {
  std::filesystem::path scene;
  std::filesystem::path architecture;
  std::vector<std::string> assignments;
  std::filesystem::path model;
  std::filesystem::path jobs;
  std::filesystem::path save_jobs;
  run_pace how = run_pace::skipping;
  std::vector<std::filesystem::path> images;
  std::filesystem::path statistics;
  std::filesystem::path log;
  std::filesystem::path waveform;
  std::optional<cycle> waveform_from;
  std::optional<cycle> waveform_to;
  std::optional<std::uint32_t> waveform_job;
  bool waveform_all = false;  ///< however large it gets
  bool quiet = false;
};

/// Traces a scene with a design and writes what was asked for. Errors: input_error, simulation_error.
void run(const run_options& options);

/// Adds the command to the program.
void add_run(CLI::App& program);

}  // namespace rtusim
