#include "modules/config/toml.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "modules/config/error.h"

namespace rtusim::config {
namespace {

/// toml++ bounds how deep values nest, but not how long a dotted key is, whose tables it destroys recursively.
void check_dotted_keys(std::string_view text, const std::string& place) {
  constexpr unsigned most_dots = 16;
  unsigned dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const std::string three(3, c);
      const bool triple = text.substr(i, 3) == three;
      for (i += triple ? 3 : 1; i < text.size(); ++i) {
        if (text[i] == '\\' && c == '"')
          ++i;
        else if (triple ? text.substr(i, 3) == three : text[i] == c || text[i] == '\n')
          break;
      }
      for (unsigned n = 1; triple && n < 5 && i + 1 < text.size() && text[i + 1] == c; ++n) ++i;  // two may precede the closing three
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '.') {
      if (++dots <= most_dots) continue;
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw input_error(fmt::format("{}:{}", place, line), "a key with too many dots", "SECTION.FIELD");
    } else if (std::strchr("=,[]{}\n", c)) {
      dots = 0;
    }
  }
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& place) {
  check_dotted_keys(text, place);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    std::string found(e.description());  // may quote a control character of the text
    std::replace_if(
        found.begin(), found.end(), [](char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }, ' ');
    throw input_error(fmt::format("{}:{}:{}", place, at.line, at.column), found, "valid TOML");
  } catch (const std::logic_error& e) {
    throw input_error(place, e.what(), "valid TOML");
  }
}

}  // namespace rtusim::config
