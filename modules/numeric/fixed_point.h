#pragma once

#include <cstdint>

#include "modules/config/section.h"

/// Bit-exact arithmetic of the hardware. Widths are run-time values; a word lives sign-extended in a host integer.
namespace rtusim::numeric {

/// A two's complement fixed-point format: `integer_bits` (with the sign) before the point, `fraction_bits` after it.
struct fixed_format {
  unsigned integer_bits = 16;
  unsigned fraction_bits = 16;

  unsigned width() const { return integer_bits + fraction_bits; }
  std::int64_t greatest() const { return static_cast<std::int64_t>((~std::uint64_t{0} >> 1) >> (64 - width())); }
  std::int64_t least() const { return -greatest() - 1; }
  double value(std::int64_t raw) const;

  void describe(config::section& s);
};

/// The low `width` bits of a word, sign-extended (1 <= width <= 64).
constexpr std::int64_t wrap(std::int64_t word, unsigned width) {
  const unsigned up = 64 - width;
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(word) << up) >> up;
}

/// floor((a + b) / 2) with the carry kept: a sum one bit wider than its operands.
template <class Int>
constexpr Int midpoint(Int a, Int b) {
  return static_cast<Int>((a & b) + ((a ^ b) >> 1));
}

/// floor((a + b) / 2) of a sum that wraps at `width` bits (1 <= width <= the host word's).
template <class Int, class Unsigned>
constexpr Int wrapped_midpoint(Int a, Int b, unsigned width) {
  const unsigned up = static_cast<unsigned>(sizeof(Int) * 8) - width;
  const auto sum = static_cast<Unsigned>(static_cast<Unsigned>(a) + static_cast<Unsigned>(b));
  return static_cast<Int>((static_cast<Int>(static_cast<Unsigned>(sum << up)) >> up) >> 1);
}

}  // namespace rtusim::numeric
