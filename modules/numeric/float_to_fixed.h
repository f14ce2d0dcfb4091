#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim::numeric {

/// Cycles from a binary32 word to its fixed-point word: unpack, three binary shifts, the last shift with the sign.
inline constexpr unsigned float_to_fixed_stages = 5;

/// What the converter as built does differently (Espe 2019, app. C.2.1).
struct float_to_fixed_errata {
  bool saturate_to_zero = false;
  bool flush_small = false;
  bool odd_exponent_lsb = false;

  void describe(config::section& s);
};

/// How often a conversion did not keep its value.
struct float_to_fixed_stats {
  std::uint64_t conversions = 0;
  std::uint64_t overflows = 0;  ///< magnitudes beyond the format, infinities among them
  std::uint64_t nans = 0;
  std::uint64_t flushed = 0;  ///< non-zero values that became zero because they are small

  float_to_fixed_stats& operator+=(const float_to_fixed_stats& s);
  void describe(config::report& r) const;
  /// Appends a sentence if words lost their value.
  void warn(std::vector<std::string>& all) const;
};

/// Converts IEEE binary32 words to fixed point, truncating toward zero, saturating; a NaN saturates by its sign bit.
class float_to_fixed_converter {
 public:
  float_to_fixed_converter(const fixed_format& format, const float_to_fixed_errata& errata);

  /// The raw word, sign-extended. What loses its value is counted; the conversions are the caller's to count.
  std::int64_t operator()(std::uint32_t float_bits, float_to_fixed_stats& stats) const {
    const unsigned biased = float_bits >> 23 & 0xff;
    // Where only two exponents fit and `flush_small` drops them, none is kept.
    if (biased - least_ >= greatest_ + 1 - least_) return at_the_ends(float_bits, stats);
    // Exact but for the conversion, which cuts toward zero as the shifters do.
    float value;
    std::memcpy(&value, &float_bits, sizeof value);
    const auto fixed = static_cast<std::int64_t>(static_cast<double>(value) * one_);
    if (!clear_lsb_) return fixed;
    const auto odd = static_cast<std::int64_t>(biased > bias) & ~static_cast<std::int64_t>(biased);
    return fixed - (fixed & odd & 1) + (fixed & odd & 1 & -static_cast<std::int64_t>(float_bits >> 31)) * 2;
  }
  /// The biased exponents between which a word keeps some of its value.
  unsigned least_exponent() const { return least_; }
  unsigned greatest_exponent() const { return greatest_; }

 private:
  static constexpr unsigned bias = 127;

  /// What is too small, too large, or no number.
  std::int64_t at_the_ends(std::uint32_t float_bits, float_to_fixed_stats& stats) const;

  fixed_format format_;
  bool saturate_to_zero_;
  bool clear_lsb_;
  unsigned least_;
  unsigned greatest_;
  double one_;  // 2^fraction_bits
};

/// One conversion of that kind.
std::int64_t float_to_fixed(std::uint32_t float_bits, const fixed_format& format, const float_to_fixed_errata& errata,
                            float_to_fixed_stats& stats);

}  // namespace rtusim::numeric
