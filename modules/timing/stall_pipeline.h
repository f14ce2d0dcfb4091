#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "modules/timing/offer.h"

namespace rtusim {

/// Stages that move together: all advance when the last is empty or its occupant leaves; bubbles are not squeezed out.
/// What enters at an edge is at the output `stages` edges later if nothing stalls.
///
/// As occupants keep their distances, each is kept with the number of the move that brings it to the output.
template <class T>
class stall_pipeline {
 public:
  explicit stall_pipeline(unsigned stages) : stages_(stages), items_(stages + 1) {}

  unsigned stages() const { return stages_; }
  bool empty() const { return size_ == 0; }
  /// Whether the last stage is occupied.
  bool output_valid() const { return size_ != 0 && items_[head_].at_output == moves_; }
  /// The cycle from which on the oldest occupant is at the output, if `next` is the next edge; never when empty.
  cycle output_from(cycle next) const { return size_ == 0 ? never : next + (items_[head_].at_output - moves_); }
  /// The oldest occupant, where it will be at the output; it stays untouched at the edge that takes it.
  const T& output() const { return items_[head_].payload; }
  /// Moves since something entered last, that edge's included; never if nothing has.
  cycle since_entry() const { return entered_ == never ? never : moves_ - entered_; }

  /// One edge. `leaves`: the occupant of the last stage is taken. Whether the stages move.
  bool advance(bool leaves) {
    if (leaves) {
      head_ = after(head_);
      --size_;
    }
    const bool moves = leaves || !output_valid();
    moves_ += moves;
    return moves;
  }
  /// Something comes in at the edge that `advance` did, at which the stages must have moved.
  T& enter() {
    entered_ = moves_ - 1;
    slot& s = items_[free_];
    free_ = after(free_);
    ++size_;
    s.at_output = entered_ + stages_;
    return s.payload;
  }
  /// `n` edges at which nothing enters or leaves.
  void idle(cycle n) { moves_ += size_ == 0 ? n : std::min(n, items_[head_].at_output - moves_); }

  /// Bit i: stage i holds something; of the first 64 stages.
  std::uint64_t valid_bits() const {
    std::uint64_t bits = 0;
    for (unsigned n = 0, i = head_; n < size_; ++n, i = after(i)) {
      const cycle stage = stages_ - 1 - (items_[i].at_output - moves_);
      if (stage < 64) bits |= std::uint64_t{1} << stage;
    }
    return bits;
  }

 private:
  struct slot {
    cycle at_output = 0;
    T payload{};
  };

  unsigned after(unsigned i) const { return i + 1 < items_.size() ? i + 1 : 0; }

  unsigned stages_;
  std::vector<slot> items_;  // a ring: [head_, free_)
  unsigned head_ = 0;
  unsigned free_ = 0;
  unsigned size_ = 0;
  cycle moves_ = 0;
  cycle entered_ = never;
};

}  // namespace rtusim
