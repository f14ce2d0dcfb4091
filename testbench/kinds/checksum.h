#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

namespace rtusim {

/// The CRC-32 of words one after the other, as a record tells it.
class checksum {
 public:
  template <class Word>
  checksum& operator()(const std::vector<Word>& words) {
    crc_ = static_cast<std::uint32_t>(crc32_z(crc_, reinterpret_cast<const Bytef*>(words.data()), words.size() * sizeof(Word)));
    return *this;
  }
  std::string text() const { return fmt::format("{:08x}", crc_); }

 private:
  std::uint32_t crc_ = 0;
};

}  // namespace rtusim
