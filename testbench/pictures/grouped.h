#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace rtusim {

/// A whole number with its thousands told apart: 2,774,799.
inline std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t place = text.size(); place > 3;) text.insert(place -= 3, 1, ',');
  return text;
}

}  // namespace rtusim
