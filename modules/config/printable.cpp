#include "modules/config/printable.h"

#include <algorithm>
#include <cstdint>

namespace rtusim::config {
namespace {

/// A character at the beginning of a text: how many bytes it takes, and whether they are one that may be shown.
struct character {
  std::size_t bytes;
  bool shown;
};

bool is_shown(std::uint32_t c) {
  const bool control = c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x2028 || c == 0x2029;  // lines and paragraphs end with the last two
  const bool turns = c == 0x61c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
  return !control && !turns;
}

/// Unicode 15, table 3-7: no overlong form, no surrogate, nothing beyond U+10FFFF.
character first_of(const char* text, std::size_t most) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return {1, is_shown(first)};
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || length > most) return {1, false};
  std::uint32_t c = first & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return {1, false};
    c = c << 6 | (byte(i) & 0x3fU);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (c < least[length] || c > 0x10ffff || (c >= 0xd800 && c < 0xe000)) return {1, false};
  return {length, is_shown(c)};
}

}  // namespace

void make_printable(char* text, std::size_t bytes) noexcept {
  for (std::size_t i = 0; i < bytes;) {
    const character c = first_of(text + i, bytes - i);
    if (!c.shown) std::fill_n(text + i, c.bytes, '?');
    i += c.bytes;
  }
}

std::string printable(std::string_view text) {
  std::string copy(text);
  make_printable(copy.data(), copy.size());
  return copy;
}

}  // namespace rtusim::config
