#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "modules/bih_core/bih_core.h"
#include "modules/config/report.h"
#include "modules/job_manager/job_manager.h"
#include "modules/job_manager/triangle_job_manager.h"
#include "modules/svo_core/svo_core.h"
#include "modules/timing/channel.h"
#include "testbench/bench/histogram.h"
#include "testbench/bench/host_figures.h"
#include "testbench/bench/scoreboard.h"

namespace rtusim {

/// All figures of a run that its inputs determine, however they were come by.
struct run_figures {
  double clock_mhz = 0;
  host_figures host;
  result_figures results;
  /// Of the job manager and the cores, of the kind that the design has.
  std::variant<job_manager::stats, triangle_job_manager::stats> jobs;
  std::variant<std::vector<svo_core::stats>, std::vector<bih_core::stats>> cores;
  std::vector<std::pair<std::string, channel_stats>> channels;  ///< by instance name, in the order of construction

  void add(const job_manager::stats& s) { jobs = s; }
  void add(const triangle_job_manager::stats& s) { jobs = s; }
  /// The next core's.
  template <class Stats>
  void add(const Stats& s) {
    if (!std::holds_alternative<std::vector<Stats>>(cores)) cores = std::vector<Stats>();
    std::get<std::vector<Stats>>(cores).push_back(s);
  }

  /// Of the words of the jobs.
  numeric::float_to_fixed_stats conversion() const;

  /// What was lost or changed on the way in, a sentence each, as a warning tells it.
  std::vector<std::string> warnings() const;

  void describe(config::report& r) const;
};

/// What figures there are, over all kinds of cores. `core_0` and the channel `job` stand for the others of their kind.
std::vector<config::report::entry> all_figures();

}  // namespace rtusim
