#pragma once

#include <algorithm>
#include <cstdint>

#include "modules/config/report.h"
#include "modules/config/section.h"

namespace rtusim {

struct result_manager_params {
  enum class order : std::uint8_t { as_finished };
  static config::word_list order_words() { return {"as_finished"}; }

  order leave = order::as_finished;
  bool valid_withdrawn = false;

  void describe(config::section& s);
};

struct result_manager_stats {
  std::uint64_t results = 0;
  std::uint64_t wait_cycles = 0;  ///< sum over the results
  std::uint64_t most_wait_cycles = 0;

  /// A result left so many cycles after it came.
  void count(std::uint64_t waited_cycles) {
    ++results;
    wait_cycles += waited_cycles;
    most_wait_cycles = std::max(most_wait_cycles, waited_cycles);
  }
  void describe(config::report& r) const;
};

}  // namespace rtusim
