#pragma once

#include <array>
#include <cstdint>

#include "modules/timing/offer.h"

namespace rtusim {

/// Stages that move together: all advance when the last is empty or its occupant leaves; bubbles are not squeezed out.
/// What enters at an edge is at the output `Stages` edges later if nothing stalls.
template <class T, unsigned Stages>
class stall_pipeline {
  static_assert(Stages >= 1 && Stages <= 32);

 public:
  bool empty() const { return valid_ == 0; }
  /// Whether the last stage is occupied.
  bool output_valid() const { return (valid_ & last) != 0; }
  /// Bit i: stage i holds something.
  std::uint32_t valid_bits() const { return valid_; }
  /// The cycle from which on the oldest occupant is at the output, if `next` is the next edge; never when empty.
  cycle output_from(cycle next) const {
    return valid_ == 0 ? never : next + static_cast<unsigned>(__builtin_clz(valid_)) - (32 - Stages);
  }
  /// The oldest occupant, where it will be at the output.
  const T& output() const { return items_[head_]; }

  /// One edge. `leaves`: the occupant of the last stage is taken; `enters`: what comes in, or null. Nothing may come in while
  /// the pipeline stalls.
  void edge(bool leaves, const T* enters) {
    if (leaves) {
      head_ = (head_ + 1) % ring;
      valid_ &= ~last;
    }
    if (!output_valid()) valid_ <<= 1;
    if (enters != nullptr) {
      valid_ |= 1;
      items_[(head_ + static_cast<unsigned>(__builtin_popcount(valid_)) - 1) % ring] = *enters;
    }
  }
  /// `n` edges at which nothing enters or leaves.
  void idle(cycle n) {
    if (valid_ == 0) return;
    const auto room = static_cast<unsigned>(__builtin_clz(valid_)) - (32 - Stages);
    valid_ <<= n < room ? static_cast<unsigned>(n) : room;
  }

 private:
  static constexpr std::uint32_t last = std::uint32_t{1} << (Stages - 1);
  static constexpr unsigned ring = Stages <= 8 ? 8 : Stages <= 16 ? 16 : 32;

  std::uint32_t valid_ = 0;
  unsigned head_ = 0;
  std::array<T, ring> items_{};
};

}  // namespace rtusim
