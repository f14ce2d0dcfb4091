#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "modules/timing/clock_domain.h"

namespace rtusim {

/// How a run comes by its cycles: the paces of the clock (`pace`, in the same order), or the replay of all rays' costs.
enum class run_pace : std::uint8_t { skipping, stepped, checked, replay };
inline constexpr std::string_view run_pace_words[] = {"skipping", "stepped", "checked", "replay"};

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

}  // namespace rtusim
