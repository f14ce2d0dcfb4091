#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "modules/timing/lfsr.h"
#include "modules/timing/offer.h"
#include "testbench/bench/surroundings.h"

/// What a schedule without a clock is put together from.
namespace rtusim::replaying {

/// When the source offers the next job.
class source_schedule {
 public:
  explicit source_schedule(const source_params& p) : params_(p) {
    if (p.valid == source_params::regime::lfsr) random_.emplace(p.seed);
  }

  cycle offered_from() const { return from_; }
  cycle next(cycle c) const { return random_ ? random_->next(c) : c; }
  void accept(cycle c) {
    valid_cycles_ += random_ ? random_->count(from_, c + 1) : c + 1 - from_;
    switch (params_.valid) {
      case source_params::regime::always:
      case source_params::regime::lfsr: from_ = c + 1; break;
      case source_params::regime::gap: from_ = c + 1 + params_.gap_cycles; break;
      case source_params::regime::paced: from_ = std::max(from_ + params_.interval_cycles, c + 1); break;
    }
  }
  std::uint64_t valid_cycles() const { return valid_cycles_; }

 private:
  source_params params_;
  std::optional<lfsr> random_;
  cycle from_ = 0;
  std::uint64_t valid_cycles_ = 0;
};

/// The job manager's stages, which stand still from the cycle in which a job is at the output to the one that dispatches it.
class stages_schedule {
 public:
  explicit stages_schedule(unsigned stages) : stages_(stages) {}

  /// The first cycle >= c in which the stages move, so that a job can be accepted.
  cycle next_move(cycle c) {
    while (first_ != last_ && stall(first_).to <= c) {
      stalled_before_ += stall(first_).to - stall(first_).from;
      ++first_;
    }
    return first_ != last_ && stall(first_).from <= c ? stall(first_).to : c;
  }
  /// The cycle from which on a job accepted in cycle c, a result of `next_move`, is at the output.
  cycle output_from(cycle c) {
    next_move(c);
    return c + stages_ + (stalled_ - stalled_before_);
  }
  /// A job at the output from cycle `from` on is dispatched in cycle `to`.
  void dispatch(cycle from, cycle to) {
    if (from == to) return;
    stall(last_++) = {from, to};
    stalled_ += to - from;
  }
  std::uint64_t stalled() const { return stalled_; }

 private:
  struct interval {
    cycle from, to;
  };  // stands still in [from, to)
  interval& stall(std::uint64_t i) { return stalls_[i % stalls_.size()]; }

  unsigned stages_;
  std::array<interval, 8> stalls_{};  // no more than the stages can hold lie ahead of a job being accepted
  std::uint64_t first_ = 0, last_ = 0;
  std::uint64_t stalled_ = 0;         // cycles of all stalls so far
  std::uint64_t stalled_before_ = 0;  // and of those before `first_`
};

/// Puts results into the order of leaving, one a cycle at most.
class leaving_order {
 public:
  struct result {
    std::uint32_t job = 0;
    std::uint32_t core = 0;
    std::uint64_t latency_cycles = 0;
  };

  void add(cycle c, const result& r) {
    while (c - base_ >= ring_.size()) grow();
    const std::size_t slot = c & (ring_.size() - 1);
    ring_[slot] = r;
    taken_[slot / 64] |= std::uint64_t{1} << (slot % 64);
  }
  /// Cycles from the first not handed out to `end`. It pays to hand out many at once.
  cycle span(cycle end) const { return end - base_; }
  static constexpr cycle batch = 2048;

  /// Hands out the results of all cycles before `end`.
  template <class Handler>
  void flush(cycle end, Handler&& handler) {
    while (base_ < end) {
      const std::size_t slot = base_ & (ring_.size() - 1);
      const std::size_t span = std::min<cycle>(64 - slot % 64, end - base_);
      std::uint64_t& word = taken_[slot / 64];
      std::uint64_t bits = word >> (slot % 64);
      if (span < 64) bits &= (std::uint64_t{1} << span) - 1;
      word &= ~(bits << (slot % 64));
      for (; bits != 0; bits &= bits - 1) {
        const auto ahead = static_cast<unsigned>(__builtin_ctzll(bits));
        handler(base_ + ahead, ring_[slot + ahead]);
      }
      base_ += span;
    }
  }

 private:
  void grow() {
    std::vector<result> ring(ring_.size() * 2);
    std::vector<std::uint64_t> taken(ring.size() / 64);
    for (cycle c = base_; c < base_ + ring_.size(); ++c) {
      const std::size_t slot = c & (ring_.size() - 1);
      if ((taken_[slot / 64] >> (slot % 64) & 1) == 0) continue;
      const std::size_t to = c & (ring.size() - 1);
      ring[to] = ring_[slot];
      taken[to / 64] |= std::uint64_t{1} << (to % 64);
    }
    ring_ = std::move(ring);
    taken_ = std::move(taken);
  }

  cycle base_ = 0;
  std::vector<result> ring_ = std::vector<result>(4096);
  std::vector<std::uint64_t> taken_ = std::vector<std::uint64_t>(4096 / 64);
};

/// A core with its result buffer.
struct core_schedule {
  cycle free_from = 0;    ///< it takes a job from this cycle on; never while that is not known
  cycle drained = never;  ///< when the last result left the buffer
  // Where drains are followed in time: the result in the buffer or on its way there, and the one after it.
  cycle buffered = never;  ///< when it came, or comes, to the buffer
  std::uint32_t job = 0;
  cycle done = never;  ///< a result waits for the buffer, or will, from this cycle on
  std::uint32_t next_job = 0;

  std::uint64_t jobs = 0, hits = 0, cost = 0, pushes = 0, depth = 0, ends = 0;
  std::uint64_t idle_cycles = 0;    ///< ready for a job
  std::uint64_t waited_cycles = 0;  ///< done, and the buffer full
  std::uint64_t full_cycles = 0;    ///< of the buffer
};

}  // namespace rtusim::replaying
