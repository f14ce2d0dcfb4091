#pragma once

#include "modules/timing/line_set.h"
#include "modules/timing/offer.h"

namespace rtusim {

/// A select register over N lines that turns by one every cycle, and the lines that are 1: the signal under the register.
/// Line selected in cycle c: (c + phase) mod N.
class rotating_select final : public pattern, public line_set {
 public:
  using line_set::line_set;

  unsigned selected(cycle c) const {
    // Cycles come in order, mostly: the line follows from the last one asked for.
    const cycle ahead = c - known_cycle_;
    if (ahead >= lines()) return remember(c, static_cast<unsigned>((c + phase_) % lines()));
    const unsigned line = known_line_ + static_cast<unsigned>(ahead);
    return remember(c, line < lines() ? line : line - lines());
  }
  /// Turns the register so that it selects `line` in cycle c.
  void select(unsigned line, cycle c);

  /// A cycle, and the line selected in it.
  struct place {
    cycle when;
    unsigned line;
  };
  /// The first cycle >= c in which the signal is 1; `never`, and a line that means nothing, if none is.
  place next_place(cycle c) const {
    if (!any() || c == never) return {never, 0};
    const unsigned now = selected(c);
    const unsigned ahead = first_from(now);
    if (ahead < lines()) return {c + ahead - now, ahead};
    const unsigned first = lowest();
    return {c + lines() + first - now, first};
  }
  cycle next(cycle c) const override { return next_place(c).when; }
  std::uint64_t count(cycle from, cycle to) const override;

 private:
  unsigned remember(cycle c, unsigned line) const {
    known_cycle_ = c;
    known_line_ = line;
    return line;
  }

  unsigned phase_ = 0;
  mutable cycle known_cycle_ = 0;  // a cycle and the line selected in it
  mutable unsigned known_line_ = 0;
};

}  // namespace rtusim
