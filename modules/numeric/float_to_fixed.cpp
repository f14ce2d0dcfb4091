#include "modules/numeric/float_to_fixed.h"

#include <cmath>

#include <fmt/format.h>

namespace rtusim::numeric {

float_to_fixed_converter::float_to_fixed_converter(const fixed_format& format, const float_to_fixed_errata& errata)
    : format_(format), saturate_to_zero_(errata.saturate_to_zero), clear_lsb_(errata.odd_exponent_lsb) {
  const auto n_i = static_cast<int>(format.integer_bits);
  const auto n_f = static_cast<int>(format.fraction_bits);
  // As built, unbiased exponents up to 1 - n_f give 0; right, those below -n_f do.
  least_ = static_cast<unsigned>((errata.flush_small ? 2 - n_f : -n_f) + static_cast<int>(bias));
  greatest_ = static_cast<unsigned>(n_i - 2 + static_cast<int>(bias));
  one_ = std::ldexp(1.0, n_f);
}

std::int64_t float_to_fixed_converter::at_the_ends(std::uint32_t float_bits, float_to_fixed_stats& stats) const {
  const bool negative = float_bits >> 31;
  const unsigned biased = float_bits >> 23 & 0xff;
  const std::uint32_t fraction = float_bits & 0x7fffff;
  if (biased < least_) {
    if (float_bits << 1 != 0) ++stats.flushed;
    return 0;
  }
  // The most negative number is the one magnitude at the limit that fits.
  const bool fits = negative && biased == greatest_ + 1 && fraction == 0;
  if (biased == 0xff && fraction != 0)
    ++stats.nans;
  else if (!fits)
    ++stats.overflows;
  if (saturate_to_zero_) return 0;
  return negative ? format_.least() : format_.greatest();
}

std::int64_t float_to_fixed(std::uint32_t float_bits, const fixed_format& format, const float_to_fixed_errata& errata,
                            float_to_fixed_stats& stats) {
  ++stats.conversions;
  return float_to_fixed_converter(format, errata)(float_bits, stats);
}

void float_to_fixed_stats::warn(std::vector<std::string>& all) const {
  if (overflows + nans != 0)
    all.push_back(fmt::format("{} parameters of the jobs lie beyond the fixed-point range, {} are no number", overflows, nans));
}

void float_to_fixed_errata::describe(config::section& s) {
  s.erratum("saturate_to_zero", saturate_to_zero, "magnitudes beyond the format, infinities and NaN give 0",
            "the nearest end of the range");
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
