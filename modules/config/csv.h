#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rtusim {

/// A table of comma-separated values (RFC 4180): a header line, then rows of as many fields.
///
/// Blanks around a field do not count. A field may stand in quotes, with two for one inside, and then hold commas and outer blanks, but no
/// line's end. A byte order mark before the table and blank lines after it are skipped.
class csv_table {
 public:
  /// Reads a file, zipped or not. Errors: input_error for a file without a header, a row with another number of fields, and a quote that
  /// does not end its field.
  explicit csv_table(const std::filesystem::path& file);

  const std::vector<std::string>& header() const { return header_; }
  std::size_t rows() const { return fields_.size() / header_.size(); }
  std::string_view field(std::size_t row, std::size_t column) const { return fields_[row * header_.size() + column]; }
  /// The column of that name, or the number of columns.
  std::size_t find(std::string_view name) const;
  /// The column of that name. Errors: input_error when there is none, or two.
  std::size_t column(std::string_view name) const;
  /// A field as a whole number, with or without sign. Errors: input_error that names line and column when it is none, or lies outside.
  std::int64_t number(std::size_t row, std::size_t column, std::int64_t least, std::int64_t most) const;

 private:
  std::string_view take_field(std::string_view& line, const std::string& place);

  std::filesystem::path file_;
  std::string text_;
  std::deque<std::string> unquoted_;  // fields that do not stand in the text as they are
  std::vector<std::string> header_;
  std::vector<std::string_view> fields_;
};

/// A table to be written: a copy of `given` in which the columns `all` stand in their order, those of them that `given` lacks behind
/// the one before them in `all`; `values` replaces the columns named in `computed`, row by row.
void write_csv(const std::filesystem::path& file, const csv_table& given, const std::vector<std::string>& all,
               const std::vector<std::string>& computed, const std::vector<std::vector<std::int64_t>>& values);
/// The same with values as they are to stand there.
void write_csv(const std::filesystem::path& file, const csv_table& given, const std::vector<std::string>& all,
               const std::vector<std::string>& computed, const std::vector<std::vector<std::string>>& values);

}  // namespace rtusim
