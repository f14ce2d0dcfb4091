#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace rtusim {

/// The value whose bytes begin at `at` and are all there, least or most significant byte first. The host's own order is the former.
template <class Value>
Value binary_value(std::string_view bytes, std::size_t at, bool big_endian) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), bytes.data() + at, raw.size());
  if (big_endian) std::reverse(raw.begin(), raw.end());
  Value value;
  std::memcpy(&value, raw.data(), raw.size());
  return value;
}

}  // namespace rtusim
