#include "modules/config/csv.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/words.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 28;  // an empty field of one byte takes sixteen in memory

constexpr std::string_view blanks = " \t";

std::string_view without_leading_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text;
}

std::string_view trimmed(std::string_view text) {
  text = without_leading_blanks(text);
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

/// A field as it must stand in a table.
std::string quoted_if_needed(std::string_view field) {
  if (field.find_first_of(",\"") == field.npos && trimmed(field).size() == field.size()) return std::string(field);
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + '"';
}

template <class Value>
void write_table(const std::filesystem::path& file, const csv_table& given, const std::vector<std::string>& all,
                 const std::vector<std::string>& computed, const std::vector<std::vector<Value>>& values) {
  std::vector<std::string> header = given.header();
  auto place = header.begin();
  for (const std::string& name : all) {
    const auto there = std::find(header.begin(), header.end(), name);
    place = (there != header.end() ? there : header.insert(place, name)) + 1;
  }
  // Where each column comes from: the computed ones first, then the given ones.
  std::vector<std::size_t> source;
  for (const std::string& name : header) {
    const auto of = std::find(computed.begin(), computed.end(), name);
    source.push_back(of != computed.end() ? static_cast<std::size_t>(of - computed.begin()) : computed.size() + given.column(name));
  }
  std::string text;
  for (const std::string& name : header) text += (text.empty() ? "" : ",") + quoted_if_needed(name);
  text += '\n';
  config::output_file out(file);
  for (std::size_t row = 0; row < given.rows(); ++row) {
    for (std::size_t c = 0; c < source.size(); ++c) {
      if (c != 0) text += ',';
      if (source[c] < computed.size())
        fmt::format_to(std::back_inserter(text), "{}", values[row][source[c]]);
      else
        text += quoted_if_needed(given.field(row, source[c] - computed.size()));
    }
    text += '\n';
    if (text.size() > 1 << 16) {
      out.write(text);
      text.clear();
    }
  }
  out.write(text);
  out.commit();
}

}  // namespace

csv_table::csv_table(const std::filesystem::path& file) : file_(file), text_(config::read_file(file, most_bytes)) {
  std::string_view rest = without_mark(text_);
  std::vector<std::string_view> fields;
  for (std::size_t number = 1; rest.find_first_not_of(" \t\r\n") != rest.npos; ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string place = fmt::format("{}:{}", file.string(), number);
    fields.clear();
    for (bool more = true; more;) {
      fields.push_back(take_field(line, place));
      more = !line.empty();
      if (more) line.remove_prefix(1);
    }
    if (number == 1) {
      header_.assign(fields.begin(), fields.end());
      continue;
    }
    if (fields.size() != header_.size())
      throw input_error(place, fmt::format("{} fields", fields.size()), fmt::format("{}, as the header has", header_.size()));
    fields_.insert(fields_.end(), fields.begin(), fields.end());
  }
  if (header_.empty()) throw input_error(file.string(), "an empty file", "a header line and rows of comma-separated values");
}

/// Takes the field at the front of a line, up to its comma.
std::string_view csv_table::take_field(std::string_view& line, const std::string& place) {
  line = without_leading_blanks(line);
  if (line.empty() || line[0] != '"') {
    const std::string_view field = line.substr(0, line.find(','));
    line.remove_prefix(field.size());
    return trimmed(field);
  }
  std::string unquoted;
  for (std::size_t at = 1;;) {
    const std::size_t quote = line.find('"', at);
    if (quote == line.npos) throw input_error(place, "a quote that does not end in its line", "another one after the field");
    unquoted += line.substr(at, quote - at);
    at = quote + 1;
    if (line.substr(at, 1) == "\"") {
      unquoted += line[at++];
      continue;
    }
    const std::string_view plain = line.substr(1, quote - 1);
    line = without_leading_blanks(line.substr(at));
    if (!line.empty() && line[0] != ',')
      throw input_error(place, "a quote that ends within a field", "a comma after it, or two quotes for one");
    return unquoted == plain ? plain : std::string_view(unquoted_.emplace_back(std::move(unquoted)));
  }
}

std::size_t csv_table::find(std::string_view name) const {
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), name) - header_.begin());
}

std::size_t csv_table::column(std::string_view name) const {
  const std::size_t c = find(name);
  if (c == header_.size()) throw input_error(file_.string() + ":1", "no column " + std::string(name), "it among the header's");
  if (std::find(header_.begin() + static_cast<std::ptrdiff_t>(c) + 1, header_.end(), name) != header_.end())
    throw input_error(file_.string() + ":1", "two columns " + std::string(name), "one");
  return c;
}

std::int64_t csv_table::number(std::size_t row, std::size_t column, std::int64_t least, std::int64_t most) const {
  const std::string_view text = field(row, column);
  const auto value = number_in<std::int64_t>(text);
  if (!value || *value < least || *value > most)
    throw input_error(fmt::format("{}:{}", file_.string(), row + 2), fmt::format("{} = \"{}\"", header_[column], text.substr(0, 40)),
                      fmt::format("a whole number from {} to {}", least, most));
  return *value;
}

void write_csv(const std::filesystem::path& file, const csv_table& given, const std::vector<std::string>& all,
               const std::vector<std::string>& computed, const std::vector<std::vector<std::int64_t>>& values) {
  write_table(file, given, all, computed, values);
}

void write_csv(const std::filesystem::path& file, const csv_table& given, const std::vector<std::string>& all,
               const std::vector<std::string>& computed, const std::vector<std::vector<std::string>>& values) {
  write_table(file, given, all, computed, values);
}

}  // namespace rtusim
