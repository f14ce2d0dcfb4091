#pragma once

#include <algorithm>
#include <cstdint>

namespace rtusim::numeric {

/// The greatest distance along a ray; the least is -greatest_distance - 1. A distance has 63 bits (Hanika 2007, sec. 3.4).
inline constexpr std::int64_t greatest_distance = (std::int64_t{1} << 62) - 1;

/// floor(difference * reciprocal / 2^fraction_bits): how far along a ray a plane lies, from the difference of their coordinates.
///
/// Deviation: what does not fit 63 bits saturates. It needs formats with n + m > 62; as built the sum is 62.
constexpr std::int64_t plane_distance(std::int64_t difference, std::int64_t reciprocal, unsigned fraction_bits) {
  __extension__ using wide = __int128;
  const wide distance = static_cast<wide>(difference) * reciprocal >> fraction_bits;
  return static_cast<std::int64_t>(std::clamp<wide>(distance, -greatest_distance - 1, greatest_distance));
}

}  // namespace rtusim::numeric
