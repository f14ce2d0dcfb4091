#pragma once

#include <cstdint>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

/// A select register over N lines that turns by one every clock, and the lines that are 1: the signal under the register.
/// Line selected in cycle c: (c + phase) mod N.
class rotating_select final : public pattern {
 public:
  explicit rotating_select(unsigned lines);

  unsigned lines() const { return lines_; }
  unsigned selected(cycle c) const {
    // Cycles come in order, mostly: the line follows from the last one asked for.
    const cycle ahead = c - known_cycle_;
    if (ahead >= lines_) return remember(c, static_cast<unsigned>((c + phase_) % lines_));
    const unsigned line = known_line_ + static_cast<unsigned>(ahead);
    return remember(c, line < lines_ ? line : line - lines_);
  }
  /// Turns the register so that it selects `line` in cycle c.
  void select(unsigned line, cycle c);

  bool line(unsigned i) const { return bits_[i / 64] >> (i % 64) & 1; }
  void set_line(unsigned i, bool on) {
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    std::uint64_t& word = bits_[i / 64];
    if (((word & bit) != 0) == on) return;
    word ^= bit;
    on_ += on ? 1u : ~0u;
  }
  bool any() const { return on_ != 0; }
  /// The lowest line that is 1; there must be one.
  unsigned lowest() const;

  cycle next(cycle c) const override;
  std::uint64_t count(cycle from, cycle to) const override;

 private:
  unsigned remember(cycle c, unsigned line) const {
    known_cycle_ = c;
    known_line_ = line;
    return line;
  }
  unsigned first_from(unsigned line) const;  // >= line, or lines_
  std::uint64_t count_lines(unsigned begin, unsigned end) const;

  unsigned lines_;
  unsigned on_ = 0;
  unsigned phase_ = 0;
  mutable cycle known_cycle_ = 0;  // a cycle and the line selected in it
  mutable unsigned known_line_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace rtusim
