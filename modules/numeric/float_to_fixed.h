#pragma once

#include <cstdint>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim::numeric {

/// Clocks from a binary32 word to its fixed-point word: unpack, three binary shifts, the last shift with the sign.
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
  std::uint64_t flushed = 0;    ///< non-zero values that became zero because they are small

  float_to_fixed_stats& operator+=(const float_to_fixed_stats& s);
  void describe(config::report& r) const;
};

/// Converts an IEEE binary32 word to fixed point, truncating toward zero, saturating; a NaN saturates by its sign bit.
/// Returns the raw word, sign-extended.
std::int64_t float_to_fixed(std::uint32_t float_bits, const fixed_format& format, const float_to_fixed_errata& errata,
                            float_to_fixed_stats& stats);

}  // namespace rtusim::numeric
