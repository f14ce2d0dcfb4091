#include "testbench/csv.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 28;  // an empty field of one byte takes sixteen in memory

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
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
  std::string text = fmt::format("{}\n", fmt::join(header, ","));
  config::output_file out(file);
  for (std::size_t row = 0; row < given.rows(); ++row) {
    for (std::size_t c = 0; c < source.size(); ++c) {
      if (c != 0) text += ',';
      if (source[c] < computed.size())
        fmt::format_to(std::back_inserter(text), "{}", values[row][source[c]]);
      else
        text += given.field(row, source[c] - computed.size());
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
  std::string_view rest = text_;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const auto fields = split(line);
    if (number == 1) {
      header_.assign(fields.begin(), fields.end());
      continue;
    }
    if (fields.size() != header_.size())
      throw input_error(fmt::format("{}:{}", file.string(), number), fmt::format("{} fields", fields.size()),
                        fmt::format("{}, as the header has", header_.size()));
    fields_.insert(fields_.end(), fields.begin(), fields.end());
  }
  if (header_.empty()) throw input_error(file.string(), "an empty file", "a header line and rows of comma-separated values");
}

std::size_t csv_table::find(std::string_view name) const {
  return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), name) - header_.begin());
}

std::size_t csv_table::column(std::string_view name) const {
  const std::size_t c = find(name);
  if (c == header_.size()) throw input_error(file_.string() + ":1", "no column " + std::string(name), "it among the header's");
  return c;
}

std::int64_t csv_table::number(std::size_t row, std::size_t column, std::int64_t least, std::int64_t most) const {
  const std::string_view text = field(row, column);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < least || value > most)
    throw input_error(fmt::format("{}:{}", file_.string(), row + 2), fmt::format("{} = \"{}\"", header_[column], text.substr(0, 40)),
                      fmt::format("a whole number from {} to {}", least, most));
  return value;
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
