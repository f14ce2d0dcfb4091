#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "modules/config/report.h"

namespace rtusim {

/// Exact counts of whole numbers.
class histogram {
 public:
  void add(std::uint64_t value) {
    if (value >= counts_.size()) counts_.resize(value + value / 2 + 64);
    ++counts_[value];
  }

  std::uint64_t total() const;
  std::uint64_t sum() const;
  /// The least value that at least `share` (0 to 1) of all values do not exceed; 0 without values.
  std::uint64_t percentile(double share) const;

  void describe(config::report& r, std::string_view unit) const;

 private:
  std::vector<std::uint64_t> counts_;
};

}  // namespace rtusim
