#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "modules/config/report.h"
#include "modules/rtu/rtu.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"
#include "testbench/bench/run_figures.h"
#include "testbench/bench/scoreboard.h"
#include "testbench/bench/stream.h"
#include "testbench/bench/surroundings.h"

namespace rtusim {

/// The cycles that a waveform shows: [from, to), or those of one job, from the first in which it may be accepted to the one in which
/// its result leaves.
struct waveform_window {
  std::filesystem::path file;
  cycle from = 0;
  cycle to = never;
  std::optional<std::uint32_t> job_id;
};

/// A design between a job source and a result sink. One a process: SystemC elaborates once.
class simulation {
 public:
  /// All arguments, and what `model` holds, must outlive the simulation.
  simulation(const design& d, const surroundings& s, const memory_contents& model, const std::vector<job_packet>& jobs, pace p,
             const std::optional<waveform_window>& window = {});

  clock_domain& clock() { return clock_; }
  scoreboard& board() { return scoreboard_; }
  rtu& dut() { return rtu_; }

  /// Runs until every job has its result.
  /// Errors: simulation_error when the watchdog ends it or a check fails; input_error for a window that the run does not reach.
  void run();

  cycle total_cycles() const { return scoreboard_.figures().total_cycles(); }
  run_figures figures();

 private:
  void follow_job(std::uint32_t job_id);

  const std::vector<job_packet>& jobs_;
  std::optional<waveform_window> window_;
  double clock_mhz_;
  clock_domain clock_;
  stream_source<job_packet> source_;
  rtu rtu_;
  any_sink sink_;
  channel<job_packet> job_{"job"};
  std::unique_ptr<channel_base> result_;
  scoreboard scoreboard_;
  std::unique_ptr<waveform> waveform_;
};

}  // namespace rtusim
