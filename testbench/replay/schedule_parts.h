#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "modules/timing/offer.h"
#include "testbench/bench/lfsr.h"
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
  explicit stages_schedule(unsigned stages) : stages_(stages), stalls_(power_of_two(stages + 2)) {}

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
  static std::size_t power_of_two(std::size_t least) {
    std::size_t size = 1;
    while (size < least) size *= 2;
    return size;
  }
  interval& stall(std::uint64_t i) { return stalls_[i & (stalls_.size() - 1)]; }

  unsigned stages_;
  std::vector<interval> stalls_;  // a ring: no more than the stages can hold lie ahead of a job being accepted
  std::uint64_t first_ = 0, last_ = 0;
  std::uint64_t stalled_ = 0;         // cycles of all stalls so far
  std::uint64_t stalled_before_ = 0;  // and of those before `first_`
};

/// What happens in which cycle, one thing a cycle at most, of cycles that lie not far apart. It is put in in any order, and comes out in
/// that of the cycles.
template <class T>
class cycle_ring {
 public:
  void put(cycle c, const T& what) {
    while (c - base_ >= slots_.size()) grow();
    const std::size_t at = c & (slots_.size() - 1);
    slots_[at] = what;
    taken_[at / 64] |= std::uint64_t{1} << (at % 64);
  }
  /// The first cycle with something, which there must be.
  cycle first() {
    for (;;) {
      const std::size_t at = base_ & (slots_.size() - 1);
      if (const std::uint64_t ahead = taken_[at / 64] >> (at % 64); ahead != 0)
        return base_ += static_cast<unsigned>(__builtin_ctzll(ahead));
      base_ = (base_ | 63) + 1;
    }
  }
  /// What it is, and nothing more from then on.
  T take_first() {
    const std::size_t at = base_ & (slots_.size() - 1);
    taken_[at / 64] &= ~(std::uint64_t{1} << (at % 64));
    return slots_[at];
  }
  /// Cycles from the first that may hold something to `end`. It pays to hand out many at once.
  cycle span(cycle end) const { return end - base_; }
  /// Hands out what happens in all cycles before `end`.
  template <class Handler>
  void flush(cycle end, Handler&& handler) {
    while (base_ < end) {
      const std::size_t at = base_ & (slots_.size() - 1);
      const std::size_t span = std::min<cycle>(64 - at % 64, end - base_);
      std::uint64_t& word = taken_[at / 64];
      std::uint64_t bits = word >> (at % 64);
      if (span < 64) bits &= (std::uint64_t{1} << span) - 1;
      word &= ~(bits << (at % 64));
      for (; bits != 0; bits &= bits - 1) {
        const auto ahead = static_cast<unsigned>(__builtin_ctzll(bits));
        handler(base_ + ahead, slots_[at + ahead]);
      }
      base_ += span;
    }
  }

 private:
  void grow() {
    std::vector<T> slots(slots_.size() * 2);
    std::vector<std::uint64_t> taken(slots.size() / 64);
    for (cycle c = base_; c < base_ + slots_.size(); ++c) {
      const std::size_t at = c & (slots_.size() - 1), to = c & (slots.size() - 1);
      if ((taken_[at / 64] >> (at % 64) & 1) == 0) continue;
      slots[to] = slots_[at];
      taken[to / 64] |= std::uint64_t{1} << (to % 64);
    }
    slots_.swap(slots);
    taken_.swap(taken);
  }

  cycle base_ = 0;
  std::vector<T> slots_ = std::vector<T>(4096);
  std::vector<std::uint64_t> taken_ = std::vector<std::uint64_t>(4096 / 64);
};

/// What both kinds of `core_schedule` have.
template <class Sums>
struct core_times {
  cycle free_from = 0;    ///< it takes a job from this cycle on; never while that is not known
  cycle drained = never;  ///< when the last result left the buffer
  // Where drains are followed in time: the result in the buffer or on its way there.
  cycle buffered = never;  ///< when it came, or comes, to the buffer
  std::uint32_t job = 0;

  std::uint64_t jobs = 0;
  Sums sums;                        ///< what only the kind of core counts
  std::uint64_t idle_cycles = 0;    ///< ready for a job
  std::uint64_t waited_cycles = 0;  ///< of results that are done, until the buffer takes them
  std::uint64_t full_cycles = 0;    ///< of the buffer
};

/// A core with its result buffer. It has one ray at a time, from the job to the buffer.
template <class Sums, bool Overlaps>
struct core_schedule : core_times<Sums> {
  explicit core_schedule(unsigned /*rays_in_flight*/) {}

  /// Its ray ends, and the result is there from cycle `done` on.
  void dispatch(cycle /*end*/, cycle done, std::uint32_t which) {
    ++this->jobs;
    done_ = done;
    next_job_ = which;
    this->free_from = never;
  }
  /// From when on a result waits, or will wait, for the buffer; never if there is none.
  cycle offered() const { return done_; }
  /// The buffer takes it in cycle c; of which job it is.
  std::uint32_t take(cycle c) {
    this->waited_cycles += c - done_;
    this->free_from = c + 1;
    done_ = never;
    return next_job_;
  }
  /// Cycles in which the buffer let a result wait.
  std::uint64_t back_pressured_cycles() const { return this->waited_cycles; }

 private:
  cycle done_ = never;
  std::uint32_t next_job_ = 0;
};

/// It takes a job as its ray ends, while less than so many results wait or are on their way. They reach the buffer in the order of jobs.
template <class Sums>
struct core_schedule<Sums, true> : core_times<Sums> {
  explicit core_schedule(unsigned rays_in_flight) : flights_(rays_in_flight) {}

  void dispatch(cycle end, cycle done, std::uint32_t which) {
    flights_[this->jobs++ % flights_.size()] = {done, never, which};
    end_ = end;
    settle();
  }
  cycle offered() const { return taken_ == this->jobs ? never : flights_[taken_ % flights_.size()].done; }
  std::uint32_t take(cycle c) {
    flight& f = flights_[taken_++ % flights_.size()];
    this->waited_cycles += c - f.done;
    back_pressured_ += c - std::max(f.done, last_taken_ + 1);
    f.taken = last_taken_ = c;
    settle();
    return f.which;
  }
  std::uint64_t back_pressured_cycles() const { return back_pressured_; }

 private:
  struct flight {
    cycle done = 0;
    cycle taken = never;
    std::uint32_t which = 0;
  };

  void settle() {
    this->free_from = end_;
    if (this->jobs < flights_.size()) return;
    // The place of the next job is that of the result that has to be gone by then.
    const cycle gone = flights_[this->jobs % flights_.size()].taken;
    this->free_from = gone == never ? never : std::max(end_, gone + 1);
  }

  std::vector<flight> flights_;  // a ring
  std::uint64_t taken_ = 0;
  cycle end_ = 0;             // of the last ray
  cycle last_taken_ = never;  // never + 1 is 0
  std::uint64_t back_pressured_ = 0;
};

}  // namespace rtusim::replaying
