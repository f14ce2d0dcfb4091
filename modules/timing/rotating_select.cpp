#include "modules/timing/rotating_select.h"

namespace rtusim {

rotating_select::rotating_select(unsigned lines) : lines_(lines), bits_((lines + 63) / 64) {}

void rotating_select::select(unsigned line, cycle c) {
  phase_ = static_cast<unsigned>((line + lines_ - c % lines_) % lines_);
  remember(c, line);
}

unsigned rotating_select::lowest() const { return first_from(0); }

unsigned rotating_select::first_from(unsigned line) const {
  for (std::size_t word = line / 64; word < bits_.size(); ++word) {
    std::uint64_t bits = bits_[word];
    if (word == line / 64) bits &= ~std::uint64_t{0} << (line % 64);
    if (bits != 0) return static_cast<unsigned>(word * 64) + static_cast<unsigned>(__builtin_ctzll(bits));
  }
  return lines_;
}

cycle rotating_select::next(cycle c) const {
  if (on_ == 0 || c == never) return never;
  const unsigned now = selected(c);
  const unsigned ahead = first_from(now);
  return ahead < lines_ ? c + (ahead - now) : c + (lines_ - now) + first_from(0);
}

std::uint64_t rotating_select::count_lines(unsigned begin, unsigned end) const {
  std::uint64_t sum = 0;
  for (std::size_t word = begin / 64; word * 64 < end; ++word) {
    std::uint64_t bits = bits_[word];
    if (word == begin / 64) bits &= ~std::uint64_t{0} << (begin % 64);
    if (end < (word + 1) * 64) bits &= (std::uint64_t{1} << (end % 64)) - 1;
    sum += static_cast<unsigned>(__builtin_popcountll(bits));
  }
  return sum;
}

std::uint64_t rotating_select::count(cycle from, cycle to) const {
  if (on_ == 0 || from >= to) return 0;
  const cycle length = to - from;
  const std::uint64_t turns = length < lines_ ? 0 : length / lines_;
  const auto rest = static_cast<unsigned>(length - turns * lines_);
  const unsigned first = selected(from);
  const std::uint64_t part =
      first + rest <= lines_ ? count_lines(first, first + rest) : count_lines(first, lines_) + count_lines(0, first + rest - lines_);
  return turns * on_ + part;
}

}  // namespace rtusim
