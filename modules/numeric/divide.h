#pragma once

#include <cstdint>

#include "modules/config/section.h"

namespace rtusim::numeric {

/// How a divider spends its cycles: one stage a bit, or one stage that does one bit a cycle.
enum class divider_kind : std::uint8_t { pipelined, iterative };
inline config::word_list divider_words() { return {"pipelined", "iterative"}; }

inline constexpr unsigned least_divider_width = 4, most_divider_width = 64;

/// A quotient word taken apart: its top bit, and the others.
struct quotient_bits {
  std::uint64_t magnitude = 0;  ///< width - 1 bits
  bool err = false;

  std::uint64_t word(unsigned width) const { return magnitude | std::uint64_t{err} << (width - 1); }
};

/// Divides signed words, one quotient bit a step, non-restoring (Hanika 2007, sec. 3.2 and A.1).
///
/// Where 0 < |d| <= 2^(width-2) and |n| < |d| the magnitude is floor(|n| 2^(width-2) / |d|). Elsewhere it is what the steps leave: their
/// remainder has width - 1 bits and wraps. err: the signs differ (0 is positive) or |n| >= |d|. The magnitude of -2^(width-1) is 0.
class divider {
 public:
  /// `width`: of operands and quotient word, 4 to 64 bits.
  explicit divider(unsigned width) : width_(width), mask_(~std::uint64_t{0} >> (65 - width)), half_(std::uint64_t{1} << (width - 2)) {}

  unsigned width() const { return width_; }

  /// Of sign-extended words.
  quotient_bits operator()(std::int64_t n, std::int64_t d) const {
    const std::uint64_t a = magnitude(n), b = magnitude(d);
    const bool below = a < b;
    return {below && b <= half_ ? ratio(a, b) : bit_by_bit(a, b), (n < 0) != (d < 0) || !below};
  }

  /// Whether the quotient of these words has err set.
  bool errs(std::int64_t n, std::int64_t d) const { return (n < 0) != (d < 0) || magnitude(n) >= magnitude(d); }

  /// The magnitude of |n| / |d| as the hardware finds it.
  std::uint64_t bit_by_bit(std::uint64_t n, std::uint64_t d) const;

 private:
  __extension__ using uint128 = unsigned __int128;

  std::uint64_t magnitude(std::int64_t word) const {
    return (word < 0 ? -static_cast<std::uint64_t>(word) : static_cast<std::uint64_t>(word)) & mask_;
  }
  std::uint64_t ratio(std::uint64_t n, std::uint64_t d) const {
    if (width_ <= 34) return (n << (width_ - 2)) / d;
    return static_cast<std::uint64_t>((uint128{n} << (width_ - 2)) / d);
  }

  unsigned width_;
  std::uint64_t mask_;  // of a magnitude
  std::uint64_t half_;  // the largest divisor whose remainders do not wrap
};

}  // namespace rtusim::numeric
