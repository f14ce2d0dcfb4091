#include "modules/numeric/float_to_fixed.h"

namespace rtusim::numeric {

std::int64_t float_to_fixed(std::uint32_t float_bits, const fixed_format& format, const float_to_fixed_errata& errata,
                            float_to_fixed_stats& stats) {
  ++stats.conversions;
  const bool negative = float_bits >> 31;
  const int exponent = static_cast<int>((float_bits >> 23) & 0xff) - 127;
  const std::uint32_t fraction = float_bits & 0x7fffff;

  // The most negative number is the one magnitude at the limit that fits.
  if (exponent >= static_cast<int>(format.integer_bits) - 1) {
    const bool fits = negative && exponent == static_cast<int>(format.integer_bits) - 1 && fraction == 0;
    if (exponent == 128 && fraction != 0)
      ++stats.nans;
    else if (!fits)
      ++stats.overflows;
    if (errata.saturate_to_zero) return 0;
    return negative ? format.least() : format.greatest();
  }

  std::uint64_t magnitude = 0;
  const bool flush = errata.flush_small && exponent <= 1 - static_cast<int>(format.fraction_bits);
  if (exponent != -127 && !flush) {
    const std::uint64_t mantissa = std::uint64_t{0x800000} | fraction;
    const int up = exponent + static_cast<int>(format.fraction_bits) - 23;
    magnitude = up >= 0 ? mantissa << up : -up < 64 ? mantissa >> -up : 0;
  }
  if (magnitude == 0) {
    if (float_bits << 1 != 0) ++stats.flushed;
    return 0;
  }
  if (errata.odd_exponent_lsb && exponent > 0 && exponent % 2 == 1) magnitude &= ~std::uint64_t{1};
  const auto value = static_cast<std::int64_t>(magnitude);
  return negative ? -value : value;
}

void float_to_fixed_errata::describe(config::section& s) {
  s.erratum("saturate_to_zero", saturate_to_zero, "magnitudes beyond the format, infinities and NaN give 0", "the nearest end of the range");
  s.erratum("flush_small", flush_small, "magnitudes below 2^-(fraction_bits - 2) give 0", "truncation to the last fraction bit");
  s.erratum("odd_exponent_lsb", odd_exponent_lsb, "positive odd exponents clear the magnitude's bit 0", "exact truncation toward zero");
}

float_to_fixed_stats& float_to_fixed_stats::operator+=(const float_to_fixed_stats& s) {
  conversions += s.conversions;
  overflows += s.overflows;
  nans += s.nans;
  flushed += s.flushed;
  return *this;
}

void float_to_fixed_stats::describe(config::report& r) const {
  r.number("conversions", conversions, "words", "binary32 words converted to fixed point");
  r.number("overflows", overflows, "words", "magnitudes beyond the fixed-point range, infinities among them");
  r.number("nans", nans, "words", "words that are not a number");
  r.number("flushed", flushed, "words", "non-zero values that became zero because they are small");
}

}  // namespace rtusim::numeric
