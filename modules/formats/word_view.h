#pragma once

#include <cstdint>

namespace rtusim {

/// A memory of 32-bit words: addresses count modulo a power of two, words outside the image read 0.
struct word_view {
  const std::uint32_t* data = nullptr;
  std::uint32_t size = 0;  ///< words of the image
  std::uint32_t address_mask = 0;

  std::uint32_t operator[](std::uint32_t address) const {
    address &= address_mask;
    return address < size ? data[address] : 0;
  }
};

}  // namespace rtusim
