#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

/// Stages that move together: all advance when the last is empty or its occupant leaves; bubbles are not squeezed out.
/// What enters at an edge is at the output `stages` edges later if nothing stalls.
///
/// As occupants keep their distances, each is kept with the cycle in which it would be at the output had nothing ever stalled.
template <class T>
class stall_pipeline {
 public:
  /// Something may enter `interval` moves after the last that did. 1 <= interval <= stages.
  explicit stall_pipeline(unsigned stages, unsigned interval = 1) : stages_(stages), interval_(interval), items_(stages + 1) {}

  unsigned stages() const { return stages_; }
  unsigned interval() const { return interval_; }
  bool empty() const { return size_ == 0; }
  /// The cycle from which on the oldest occupant is at the output; never when empty.
  cycle output_from() const { return size_ == 0 ? never : items_[head_].unstalled + stalled_; }
  /// The cycle from which on the interval is over, if nothing stalls from now on.
  cycle room_from() const { return room_ + stalled_; }
  /// The oldest occupant, where it will be at the output; it stays untouched until something has entered after it left.
  const T& output() const { return items_[head_].payload; }

  /// The oldest is taken from the last stage at edge c: all stood since it came there, and move at c.
  void leave(cycle c) {
    stalled_ = c - items_[head_].unstalled;
    head_ = after(head_);
    --size_;
  }
  /// Something comes in at edge c, at which the stages move.
  T& enter(cycle c) {
    slot& s = items_[free_];
    free_ = after(free_);
    ++size_;
    s.unstalled = c + stages_ - stalled_;
    room_ = c + interval_ - stalled_;
    return s.payload;
  }

  /// Bit i: stage i holds something in cycle c; of the first 64 stages.
  std::uint64_t valid_bits(cycle c) const {
    std::uint64_t bits = 0;
    c = std::min(c, output_from());
    for (unsigned n = 0, i = head_; n < size_; ++n, i = after(i)) {
      const cycle stage = stages_ - 1 - (items_[i].unstalled + stalled_ - c);
      if (stage < 64) bits |= std::uint64_t{1} << stage;
    }
    return bits;
  }

 private:
  struct slot {
    cycle unstalled = 0;
    T payload{};
  };

  unsigned after(unsigned i) const { return i + 1 < items_.size() ? i + 1 : 0; }

  unsigned stages_;
  unsigned interval_;
  std::vector<slot> items_;  // a ring: [head_, free_)
  unsigned head_ = 0;
  unsigned free_ = 0;
  unsigned size_ = 0;
  cycle stalled_ = 0;  // cycles in which the stages stood
  cycle room_ = 0;     // when the interval would be over had nothing ever stalled
};

}  // namespace rtusim
