#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rtusim {

/// The beginning of a text, fit for a one-line message: what can't be printed becomes a question mark.
inline std::string printable(std::string_view text, std::size_t most_characters) {
  std::string shown;
  for (const char c : text.substr(0, most_characters)) shown.push_back(c >= ' ' && c <= '~' ? c : '?');
  return shown;
}

/// The beginning of a piece of a file, between quotation marks.
inline std::string quotation(std::string_view text) { return '"' + printable(text, 40) + '"'; }

}  // namespace rtusim
