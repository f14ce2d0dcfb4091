#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rtusim {

/// N lines, each 0 or 1, all 0 at first.
class line_set {
 public:
  explicit line_set(unsigned lines) : lines_(lines), bits_((lines + 63) / 64) {}

  unsigned lines() const { return lines_; }
  bool line(unsigned i) const { return bits_[i / 64] >> (i % 64) & 1; }
  void set_line(unsigned i, bool on) {
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    std::uint64_t& word = bits_[i / 64];
    if (((word & bit) != 0) == on) return;
    word ^= bit;
    on_ += on ? 1u : ~0u;
  }
  bool any() const { return on_ != 0; }
  /// How many are 1.
  unsigned ones() const { return on_; }
  /// The lowest line that is 1; `lines()` if none is.
  unsigned lowest() const { return first_from(0); }
  /// The first line >= i that is 1, or `lines()`.
  unsigned first_from(unsigned i) const {
    if (lines_ <= 64) {
      const std::uint64_t bits = bits_.front() >> i;
      return bits == 0 ? lines_ : i + static_cast<unsigned>(__builtin_ctzll(bits));
    }
    for (std::size_t word = i / 64; word < bits_.size(); ++word) {
      std::uint64_t bits = bits_[word];
      if (word == i / 64) bits &= ~std::uint64_t{0} << (i % 64);
      if (bits != 0) return static_cast<unsigned>(word * 64) + static_cast<unsigned>(__builtin_ctzll(bits));
    }
    return lines_;
  }
  /// How many of the lines [begin, end) are 1.
  unsigned ones_within(unsigned begin, unsigned end) const {
    unsigned sum = 0;
    for (std::size_t word = begin / 64; word * 64 < end; ++word) {
      std::uint64_t bits = bits_[word];
      if (word == begin / 64) bits &= ~std::uint64_t{0} << (begin % 64);
      if (end < (word + 1) * 64) bits &= (std::uint64_t{1} << (end % 64)) - 1;
      sum += static_cast<unsigned>(__builtin_popcountll(bits));
    }
    return sum;
  }

 private:
  unsigned lines_;
  unsigned on_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace rtusim
