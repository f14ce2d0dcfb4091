#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/config/report.h"
#include "modules/config/unit_figures.h"
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
  std::vector<named_figures> units;                             ///< in the order of construction
  std::vector<std::pair<std::string, channel_stats>> channels;  ///< by instance name, in the order of construction
  std::string_view followed;                                    ///< no figure: what a replay went along; else empty

  /// What was lost or changed on the way in, a sentence each, as a warning tells it.
  std::vector<std::string> warnings() const;

  void describe(config::report& r) const;
};

}  // namespace rtusim
