#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace rtusim {

/// A text without the byte order mark of UTF-8 that some editors put before it.
std::string_view without_mark(std::string_view text);

/// A number's word without its plus sign, which `std::from_chars` does not know; "+-1" stays what it is.
inline std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

/// The number that a word is, whatever the locale: decimal, with or without sign, point and exponent. Real ones round to nearest; what is
/// too small becomes 0 and what is too large infinite; "nan" and "inf" are numbers. Nothing if the word is anything else.
template <class Number>
std::optional<Number> number_in(std::string_view word) {
  word = without_plus(word);
  const char* const last = word.data() + word.size();
  Number value{};
  auto [end, status] = std::from_chars(word.data(), last, value);
  if constexpr (std::is_same_v<Number, double>) {
    if (status == std::errc::result_out_of_range) {  // which does not say on which side
      long double wider{};
      status = std::from_chars(word.data(), last, wider).ec;
      value = static_cast<double>(wider);
    }
  }
  if (status != std::errc{} || end != last) return std::nullopt;
  return value;
}

/// Takes a text apart into words between blanks, line by line. A line ends with LF, CR LF or CR.
class word_reader {
 public:
  enum class syntax : std::uint8_t {
    plain,
    obj,  ///< `#` begins a remark up to the end of its line, and a backslash there, outside of a remark, joins the next line
  };

  /// `place` names the text in errors and must outlive this; `first_line` is the number of the text's first line.
  word_reader(std::string_view text, const std::string& place, syntax s = syntax::plain, std::uint64_t first_line = 1)
      : text_(text), place_(place), obj_(s == syntax::obj), line_(first_line) {}

  /// Takes the next word of the line; empty at its end.
  std::string_view in_line();
  /// Takes the next word, of this line or a later one; empty at the end of the text.
  std::string_view anywhere();
  /// Goes beyond the end of the line; false, and nothing happens, at the end of the text.
  bool next_line();
  /// A coordinate out of a word. Errors: input_error when it is no finite number; `what` tells what was expected.
  double coordinate(std::string_view word, const char* what) const;
  /// The place with the number of the line.
  std::string here() const;

 private:
  std::size_t line_end(std::size_t at) const;  // how many bytes of a line's end begin there
  void skip_blanks();

  std::string_view text_;
  const std::string& place_;
  bool obj_;
  std::size_t at_ = 0;
  std::uint64_t line_;
};

/// Whether a word is this one in any case; `lower` is in lower case.
bool is_word(std::string_view word, std::string_view lower);

}  // namespace rtusim
