#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include <nlohmann/json.hpp>

#include "testbench/bench/host_figures.h"
#include "testbench/bench/run_figures.h"
#include "testbench/bench/scoreboard.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/loaded_model.h"
#include "testbench/replay/replay.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"

/// The one way from a set-up to a record, for run, rerun and each point of a sweep.
namespace rtusim {

/// How a run comes by its cycles: the paces of the clock (`pace`, in the same order), or the replay of all rays' costs.
enum class run_pace : std::uint8_t { skipping, stepped, checked, replay };
inline constexpr std::string_view run_pace_words[] = {"skipping", "stepped", "checked", "replay"};

/// The quickest pace that covers a set-up.
run_pace quickest_pace(const run_setup& s);

/// What goes into a run before time does: the model in the memories, the rays on their way, and where several designs replay them, their
/// walks.
struct run_inputs {
  /// Reads the model, settles what the set-up leaves to it, and makes the jobs; of `job_file`, if named, it reads them.
  /// `pictured`: each ray of a list needs a pixel. Errors: input_error for files that can't be used, and those of `loaded_model::jobs`.
  run_inputs(run_setup& s, const std::filesystem::path& job_file, unsigned threads, bool pictured);

  /// Walks the jobs for designs that share them, where replay covers this one.
  void walk(const run_setup& s, unsigned threads);

  std::unique_ptr<loaded_model> model;
  sent_jobs sent;
  std::unique_ptr<const ray_walker> walker;   ///< null where nobody shares walks
  std::unique_ptr<const walked_rays> walked;  ///< its
  nlohmann::ordered_json record;              ///< sizes and checksums; files by their names, those that nobody gave empty
};

/// How a run goes, and who looks on.
struct run_manner {
  run_pace pace = run_pace::skipping;
  std::optional<waveform_window> window;
  result_handler each;                               ///< of each result as it leaves, if not empty
  std::function<void(std::uint64_t rays)> progress;  ///< now and then, if not empty; a replay is too quick
  unsigned threads = 2;                              ///< that a replay walks with
};

struct traced_run {
  run_figures figures;
  simulator_figures speed;  ///< but for `all_seconds`
};

/// Runs a set-up. Errors: input_error for a pace that does not cover it or a window that it does not reach; simulation_error for a fault of
/// its own.
traced_run trace(const run_setup& s, const run_inputs& inputs, const run_manner& manner);

/// The record of a run.
run_record record_of(const run_setup& s, const run_inputs& inputs, const traced_run& run);

}  // namespace rtusim
