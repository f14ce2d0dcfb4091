#pragma once

#include <algorithm>
#include <cstdint>

/// Time in this model: edges of a clock, counted from 0, the first edge after reset.
namespace rtusim {

using cycle = std::uint64_t;
inline constexpr cycle never = ~cycle{0};

/// Cycles of [from, to) that lie at or after `first`.
inline std::uint64_t cycles_from(cycle first, cycle from, cycle to) {
  const cycle begin = std::max(first, from);
  return begin < to ? to - begin : 0;
}

/// In which cycles a signal is 1, where that is more than "from some cycle on": a pure function of the cycle.
class pattern {
 public:
  virtual ~pattern() = default;
  /// The first cycle >= c in which the signal is 1, or never.
  virtual cycle next(cycle c) const = 0;
  /// In how many cycles of [from, to) it is 1.
  virtual std::uint64_t count(cycle from, cycle to) const = 0;
};

/// A promise of a port: when it asserts valid (or ready) if nothing transfers on its unit before then. A stamp, and perhaps a question. It
/// ends with the transfer.
struct offer {
  cycle from = never;             ///< not before this cycle,
  const pattern* when = nullptr;  ///< and then in these cycles; null: in all

  static offer none() { return {}; }
  static offer always_from(cycle c) { return {c, nullptr}; }
  static offer in(const pattern& p, cycle from = 0) { return {from, &p}; }

  cycle next(cycle c) const {
    c = std::max(c, from);
    return when == nullptr || c == never ? c : when->next(c);
  }
  bool asserts(cycle c) const { return next(c) == c; }
};

}  // namespace rtusim
