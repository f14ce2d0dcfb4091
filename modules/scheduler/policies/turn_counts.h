#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "modules/numeric/divisor.h"

namespace rtusim {

/// In how many cycles a select that turns by one every cycle pointed at each of N lines, over many intervals. An interval costs the same
/// whatever its length.
class turn_counts {
 public:
  explicit turn_counts(unsigned lines) : lines_(lines), by_lines_(lines), steps_(lines + 1) {}

  /// An interval of so many cycles, in the first of which the select pointed at line `first`.
  void add(unsigned first, std::uint64_t cycles) {
    const std::uint64_t turns = by_lines_.quotient(cycles);
    whole_turns_ += turns;
    const unsigned end = first + static_cast<unsigned>(cycles - turns * lines_);
    ++steps_[first];
    if (end <= lines_) {
      --steps_[end];
    } else {
      ++steps_[0];
      --steps_[end - lines_];
    }
  }
  std::uint64_t cycles(unsigned line) const {
    const auto beyond = std::accumulate(steps_.begin(), steps_.begin() + line + 1, std::int64_t{0});
    return whole_turns_ + static_cast<std::uint64_t>(beyond);
  }

 private:
  unsigned lines_;
  divisor by_lines_;
  std::uint64_t whole_turns_ = 0;    // cycles that every line has had
  std::vector<std::int64_t> steps_;  // and those beyond: the difference from one line to the next
};

}  // namespace rtusim
