#include "modules/timing/calendar.h"

namespace rtusim {

cycle calendar::earliest() {
  // A slot may have been emptied by a booking that moved away: its bit is cleared when it is met.
  const auto first = static_cast<std::size_t>(base_ % slots);
  for (std::size_t word = first / 64, seen = 0; seen <= slots / 64; word = (word + 1) % (slots / 64), ++seen) {
    std::uint64_t bits = occupied_[word];
    if (seen == 0) bits &= ~std::uint64_t{0} << (first % 64);
    if (seen == slots / 64) bits &= (std::uint64_t{1} << (first % 64)) - 1;
    while (bits != 0) {
      const auto slot = word * 64 + static_cast<std::size_t>(__builtin_ctzll(bits));
      if (wheel_[slot] != nullptr) return wheel_[slot]->at;
      occupied_[word] &= ~(std::uint64_t{1} << (slot % 64));
      bits &= bits - 1;
    }
  }
  cycle least = never;
  for (const booking* b = far_; b != nullptr; b = b->next_) least = std::min(least, b->at);
  return least;
}

void calendar::draw_in() {
  for (booking* b = far_; b != nullptr;) {
    booking* const following = b->next_;
    if (b->at - base_ < slots) {
      const cycle at = b->at;
      unlink(*b);
      b->at = never;
      book(*b, at);
    }
    b = following;
  }
}

}  // namespace rtusim
