#pragma once

#include <algorithm>
#include <numeric>
#include <string_view>
#include <vector>

#include "modules/scheduler/policies/any_ready_core.h"

namespace rtusim {

/// Cores in the order in which they took their last jobs; those that took none come first, by their indices.
class order_of_last_jobs {
 public:
  explicit order_of_last_jobs(unsigned cores) : cores_(cores) { std::iota(cores_.begin(), cores_.end(), 0u); }

  template <class Lines>
  unsigned first(const Lines& ready) const {
    for (const unsigned core : cores_)
      if (ready.line(core)) return core;
    return ready.lines();
  }
  void took(unsigned core) {
    const auto at = std::find(cores_.begin(), cores_.end(), core);
    std::rotate(at, at + 1, cores_.end());
  }

 private:
  std::vector<unsigned> cores_;
};

/// No select; of the cores that are ready, the one that took its last job longest ago, or none so far.
class least_recently_used : public any_ready_core<order_of_last_jobs> {
 public:
  static constexpr std::string_view name = "least_recently_used";
  static constexpr std::string_view meaning = "the ready core that took its last job longest ago";

  using any_ready_core::any_ready_core;
};

}  // namespace rtusim
