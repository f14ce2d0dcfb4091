#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "modules/config/report.h"
#include "modules/job_manager/job_manager.h"
#include "modules/svo_core/svo_core.h"
#include "modules/timing/channel.h"
#include "testbench/histogram.h"
#include "testbench/scoreboard.h"

namespace rtusim {

/// All figures of a run that its inputs determine, however they were come by.
struct run_figures {
  double clock_mhz = 0;
  result_figures results;
  job_manager::stats jobs;
  std::vector<svo_core::stats> cores;
  std::vector<std::pair<std::string, channel_stats>> channels;  ///< by instance name, in the order of construction

  void describe(config::report& r) const;
};

}  // namespace rtusim
