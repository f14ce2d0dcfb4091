#include "modules/config/words.h"

#include <algorithm>
#include <cmath>

#include "modules/config/error.h"
#include "modules/config/quotation.h"

namespace rtusim {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

}  // namespace

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if (text.substr(0, mark.size()) == mark) text.remove_prefix(mark.size());
  return text;
}

std::size_t word_reader::line_end(std::size_t at) const {
  if (at >= text_.size()) return 0;
  if (text_[at] == '\n') return 1;
  if (text_[at] != '\r') return 0;
  return at + 1 < text_.size() && text_[at + 1] == '\n' ? 2 : 1;
}

void word_reader::skip_blanks() {
  for (;;) {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    if (!obj_ || at_ >= text_.size() || text_[at_] != '\\') return;
    const std::size_t end = line_end(at_ + 1);
    if (end == 0) return;
    at_ += 1 + end;
    ++line_;
  }
}

std::string_view word_reader::in_line() {
  skip_blanks();
  const std::size_t from = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && line_end(at_) == 0) {
    if (obj_ && (text_[at_] == '#' || (text_[at_] == '\\' && line_end(at_ + 1) != 0))) break;
    ++at_;
  }
  return text_.substr(from, at_ - from);
}

std::string_view word_reader::anywhere() {
  std::string_view word = in_line();
  while (word.empty() && next_line()) word = in_line();
  return word;
}

bool word_reader::next_line() {
  std::size_t end = line_end(at_);
  for (bool remark = false; end == 0 && at_ < text_.size(); end = line_end(at_)) {
    remark |= text_[at_] == '#';
    if (const std::size_t joined = obj_ && !remark && text_[at_] == '\\' ? line_end(at_ + 1) : 0; joined != 0) {
      at_ += joined;
      ++line_;
    }
    ++at_;
  }
  if (end == 0) return false;
  at_ += end;
  ++line_;
  return true;
}

double word_reader::coordinate(std::string_view word, const char* what) const {
  const auto value = number_in<double>(word);
  if (value && std::isfinite(*value)) return *value;
  throw input_error(here(), word.empty() ? "the end of the line" : quotation(word), what);
}

std::string word_reader::here() const { return fmt::format("{}:{}", place_, line_); }

bool is_word(std::string_view word, std::string_view lower) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b; };
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(), same);
}

}  // namespace rtusim
