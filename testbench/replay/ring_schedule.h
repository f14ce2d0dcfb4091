#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/scheduler/policies/turn_counts.h"
#include "testbench/replay/counted_schedule.h"
#include "testbench/replay/schedule_parts.h"

namespace rtusim::replaying {

/// The replay where source and sink are always there and the select turns, of cores that have one ray at a time: nothing is fed back.
///
/// Scheduler and result multiplexer turn alike, so a core drains and takes its next job in one cycle: after one that it took in cycle c, in
/// cycle c + N ceil((cost + 2) / N). As a job is at hand in each of these cycles while there are any, a ring of them is the schedule.
template <class Way>
class ring_schedule final : public counted_schedule<Way> {
  using base = counted_schedule<Way>;

 public:
  using typename base::walked_ray;
  using typename base::walked_type;
  static_assert(!Way::overlaps);

  ring_schedule(const design& d, const surroundings& s, const walked_type& walked, const result_handler& handler)
      : base(d, s, walked, handler), stages_(way_.job_latency_cycles()), lately_(stages_) {
    // A core that waits for its first job takes it as the select comes to it.
    for (cycle c = stages_; c < stages_ + cores_.size(); ++c) turns_.put(c, {nobody, 0});
  }

  void advance(std::size_t end) override {
    while (next_job_ < end) turn();
  }
  run_figures finish() override {
    while (left_ < walked_.size()) turn();
    check_watchdog(last_dispatch_, last_result_);
    const std::uint64_t jobs = walked_.size();
    // From the first to the last dispatch a job is shown in each cycle.
    turn_counts shown(static_cast<unsigned>(cores_.size()));
    if (jobs != 0) shown.add(by_cores_.remainder(stages_), last_dispatch_ + 1 - stages_);
    std::uint64_t ready = pending_ready_;
    for (unsigned i = 0; i < cores_.size(); ++i) ready += turns_of(i, cores_[i].free_from, after_last());
    const std::uint64_t accepting = jobs == 0 ? 0 : figures_.results.last_accepted + 1;
    return collect("turns", {accepting, after_last() - dispatches_.jobs.cycles, ready, jobs, after_last()},
                   [&](unsigned core) { return shown.cycles(core); });
  }

 private:
  using base::by_cores_, base::check_watchdog, base::collect, base::cores_, base::dispatches_, base::after_last, base::figures_,
      base::last_dispatch_, base::last_result_, base::leave, base::next_job_, base::results_, base::traverse, base::walked_, base::way_;
  using typename base::core_type;

  static constexpr std::uint32_t nobody = ~std::uint32_t{0};
  struct leaving {
    std::uint32_t job;
    cycle accepted;
  };

  /// In how many cycles of [from, to) the select points at a core.
  std::uint64_t turns_of(unsigned core, cycle from, cycle to) const {
    const unsigned first = by_cores_.remainder(from);
    const cycle turn = from + (core >= first ? core - first : core + cores_.size() - first);
    return turn < to ? by_cores_.quotient(to - 1 - turn) + 1 : 0;
  }

  /// A core whose turn it is lets its result go and takes a job.
  void turn() {
    const cycle c = turns_.first();
    const leaving gone = turns_.take_first();
    const std::uint64_t turned = selected_ + (c - selected_in_);
    selected_ = turned < cores_.size() ? static_cast<unsigned>(turned) : by_cores_.remainder(turned);
    selected_in_ = c;
    core_type& core = cores_[selected_];
    if (gone.job != nobody) {
      leave(c, gone.job, selected_, c - gone.accepted);
      last_result_ = c;
      ++left_;
    }
    if (next_job_ == walked_.size()) return;

    const std::uint32_t j = next_job_++;
    const walked_ray& ray = walked_.rays[j];
    // The stages take a job in as they move, which is when they let one go.
    cycle& slot = lately_[stage_];
    stage_ = stage_ + 1 < stages_ ? stage_ + 1 : 0;
    const cycle accepted = j < stages_ ? j : slot;
    slot = c;
    figures_.results.last_accepted = accepted;
    const cycle offered = j == 0 ? stages_ : last_dispatch_ + 1;
    check_watchdog(last_dispatch_, c);
    dispatches_.jobs.add(c - offered);
    last_dispatch_ = c;
    // After the first job the core is taken in the first turn in which it is ready.
    pending_ready_ += gone.job == nobody ? turns_of(selected_, core.free_from, c + 1) : 1;
    core.idle_cycles += c - core.free_from + 1;
    way_.check(ray, selected_, j, c);
    const cycle done = traverse(ray, core, accepted, c);
    const cycle drained = c + by_cores_.quotient(done - c + cores_.size()) * cores_.size();
    ++core.jobs;
    core.free_from = done + 1;
    core.full_cycles += drained - done;
    results_.results.add(drained - done);
    turns_.put(drained, {j, accepted});
  }

  cycle_ring<leaving> turns_;
  unsigned stages_;
  std::vector<cycle> lately_;  // a ring: when the last jobs were dispatched
  unsigned stage_ = 0;
  unsigned selected_ = 0;  // in cycle `selected_in_`
  cycle selected_in_ = 0;
  std::size_t left_ = 0;
  std::uint64_t pending_ready_ = 0;
};

}  // namespace rtusim::replaying
