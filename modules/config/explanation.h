#pragma once

#include <string>
#include <vector>

namespace rtusim::config {

/// What there is to say of a parameter.
struct explanation {
  std::string key;
  std::string preset;  ///< its default
  std::string values;  ///< which it may have, with their unit
  std::string meaning;
  std::vector<std::string> notes;  ///< other names and forms of it, and when it is read
};

/// As columns for a terminal; empty if there are none.
std::string explanation_text(const std::vector<explanation>& rows);

/// As Markdown: a heading and a table a section.
std::string explanation_markdown(const std::vector<explanation>& rows);

/// A row of a Markdown table; what would end a cell is escaped.
std::string markdown_row(const std::vector<std::string>& cells);

}  // namespace rtusim::config
