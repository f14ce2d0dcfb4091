#include "modules/config/explanation.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include <fmt/format.h>

namespace rtusim::config {
namespace {

std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > width)
      lines.push_back(word);
    else
      lines.back() += ' ' + word;
  }
  return lines;
}

}  // namespace

std::string explanation_text(const std::vector<explanation>& rows) {
  if (rows.empty()) return {};
  std::vector<explanation> all{{"key", "default", "values, meaning, and when it is read", "", {}}};
  all.insert(all.end(), rows.begin(), rows.end());

  constexpr std::size_t page_columns = 100, most_preset_columns = 24;
  std::size_t key_columns = 0, preset_columns = 0;
  for (const auto& r : all) {
    key_columns = std::max(key_columns, r.key.size());
    if (r.preset.size() <= most_preset_columns) preset_columns = std::max(preset_columns, r.preset.size());
  }
  const std::size_t text_columns = std::max<std::size_t>(40, page_columns - std::min(page_columns, key_columns + preset_columns + 4));
  std::string text;
  for (const auto& r : all) {
    std::string left = fmt::format("{:{}}  {:{}}  ", r.key, key_columns, r.preset, preset_columns);
    if (r.preset.size() > preset_columns) {
      text += fmt::format("{:{}}  {}\n", r.key, key_columns, r.preset);
      left.assign(key_columns + preset_columns + 4, ' ');
    }
    std::vector<std::string> texts{r.values, r.meaning};
    texts.insert(texts.end(), r.notes.begin(), r.notes.end());
    for (const auto& words : texts)
      for (const auto& line : wrapped(words, text_columns)) {
        text += left + line + '\n';
        left.assign(key_columns + preset_columns + 4, ' ');
      }
  }
  return text;
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const auto& cell : cells) {
    row += ' ';
    for (const char c : cell) row += c == '|' || c == '<' || c == '*' ? std::string{'\\', c} : std::string{c};
    row += " |";
  }
  return row + '\n';
}

std::string explanation_markdown(const std::vector<explanation>& rows) {
  std::string text, open;
  for (const auto& r : rows) {
    if (const std::string section = r.key.substr(0, r.key.find('.')); section != open) {
      text += fmt::format("{}### {}\n\n", text.empty() ? "" : "\n", section);
      text += markdown_row({"key", "default", "values", "meaning"}) + "| --- | --- | --- | --- |\n";
      open = section;
    }
    std::string meaning = r.meaning;
    for (const auto& note : r.notes) meaning += "; " + note;
    text += markdown_row({'`' + r.key + '`', r.preset.empty() ? "" : '`' + r.preset + '`', r.values, meaning});
  }
  return text;
}

}  // namespace rtusim::config
