#pragma once

#include <cstdint>
#include <string>

/// Model files put together byte by byte.
namespace rtusim::test {

template <class Value>
void append(std::string& bytes, Value value, bool big_endian = false) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) raw = std::string(raw.rbegin(), raw.rend());
  bytes += raw;
}

/// A GLB of two chunks (glTF 2.0, sec. 4.4). The text is filled up with blanks; the buffer is taken as it is.
inline std::string glb_of(std::string json, const std::string& buffer) {
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string s = "glTF";
  append(s, std::uint32_t{2});
  append(s, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + buffer.size()));
  append(s, static_cast<std::uint32_t>(json.size()));
  s += "JSON" + json;
  append(s, static_cast<std::uint32_t>(buffer.size()));
  return s + std::string("BIN\0", 4) + buffer;
}

}  // namespace rtusim::test
