#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/schema.h"
#include "modules/rtu/design.h"
#include "scenes/scene.h"
#include "testbench/bench/surroundings.h"
#include "testbench/kinds/host_kind.h"

namespace rtusim {

/// What a run is made of: files and values in the order in which the later win. Empty: not given.
struct run_sources {
  std::filesystem::path scene;
  std::filesystem::path architecture;
  std::vector<std::string> assignments;  ///< KEY=VALUE
  std::filesystem::path model;           ///< in place of the scene's
};

/// All that describes a run, and the schema over it: every parameter that there is.
struct run_parameters {
  design hardware;
  host_kinds hosts;
  surroundings bench;
  scene what;
  config::schema parameters;

  run_parameters();
  /// The host's side of the cores.
  const host_kind& host() const { return hosts.of(hardware); }
  run_parameters(const run_parameters&) = delete;
  run_parameters& operator=(const run_parameters&) = delete;
};

/// These with the values of a run.
struct run_setup : run_parameters {
  /// Errors: input_error for files and values that can't be used, a value that nothing reads, no model.
  explicit run_setup(const run_sources& from);
  /// A run as a statistics file records it, whose files are named from `folder`. Errors: as above; `place` names the file.
  run_setup(const nlohmann::json& recorded_parameters, const std::string& place, const std::filesystem::path& folder);

 private:
  void start_files_at(const std::filesystem::path& folder);
  void check() const;
};

}  // namespace rtusim
