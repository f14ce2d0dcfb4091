#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/report.h"
#include "modules/timing/clock_domain.h"

namespace rtusim {

/// What is kept of a run: a versioned JSON file. All but `simulator` depends on the inputs alone. The file names its inputs from its own
/// folder, so that it does not depend on where it was written from; here they are named from the current directory.
struct run_record {
  static constexpr int version = 3;

  nlohmann::ordered_json inputs;
  nlohmann::ordered_json parameters;
  nlohmann::ordered_json statistics;
  nlohmann::ordered_json simulator;
};

/// Appends all values of a tree of figures with their path, A.B.C after `key`, in its order.
void flatten(const nlohmann::ordered_json& from, const std::string& key, std::vector<std::pair<std::string, nlohmann::ordered_json>>& to);

/// The simulator itself: which one it is, and its speed.
struct simulator_figures {
  std::string pace;
  std::string followed;  ///< by a replay
  std::uint64_t rays = 0;
  std::uint64_t cycles = 0;
  double run_seconds = 0;
  double all_seconds = 0;
  clock_stats clock;

  void describe(config::report& r) const;
};

/// What a statistics file holds that lies in this folder; see `folder_of_record`.
std::string record_text(run_record record, const std::filesystem::path& folder);

/// Errors: input_error when the file can't be written.
void write_record(const std::filesystem::path& file, const run_record& record);

/// A page for a person: throughput, where the cycles of a ray went, how busy the cores were, who waits for whom.
std::string summary_text(const run_record& record);

}  // namespace rtusim
