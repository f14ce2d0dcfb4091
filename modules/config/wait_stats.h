#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "modules/config/report.h"

namespace rtusim {

/// How long what passed through a unit waited there.
struct wait_stats {
  std::uint64_t count = 0;
  std::uint64_t cycles = 0;  ///< sum over all
  std::uint64_t most_cycles = 0;

  void add(std::uint64_t waited_cycles) {
    ++count;
    cycles += waited_cycles;
    most_cycles = std::max(most_cycles, waited_cycles);
  }
  /// As a group `wait`.
  void describe(config::report& r, std::string_view mean_meaning, std::string_view most_meaning) const {
    r.group("wait", [&](config::report& g) {
      g.number("mean", count == 0 ? 0.0 : static_cast<double>(cycles) / static_cast<double>(count), "cycles", mean_meaning);
      g.number("most", most_cycles, "cycles", most_meaning);
    });
  }
};

}  // namespace rtusim
