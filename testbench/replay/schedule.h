#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "modules/rtu/design.h"
#include "modules/scheduler/policies/policies.h"
#include "testbench/replay/counted_schedule.h"
#include "testbench/replay/ring_schedule.h"
#include "testbench/replay/schedule_parts.h"
#include "testbench/replay/walks.h"

namespace rtusim::replaying {

/// One replay, job by job. `Held`: an offered result stays and the sink is not always ready. `Policy`: of the scheduler.
template <bool Held, class Policy, class Way>
class schedule final : public counted_schedule<Way> {
  using base = counted_schedule<Way>;

 public:
  using typename base::walked_ray;
  using typename base::walked_type;

  schedule(const design& d, const surroundings& s, const walked_type& walked, const result_handler& handler)
      : base(d, s, walked, handler),
        policy_(d.rtu.cores),
        source_(s.source),
        stages_(way_.job_latency_cycles()),
        accepted_(Held ? walked.size() : 0) {
    if (s.sink.ready == sink_params::regime::lfsr) sink_.emplace(s.sink.seed);
  }

  /// Follows the jobs before `end`, which are walked.
  void advance(std::size_t end) override {
    for (; next_job_ < end; ++next_job_) replay_job(next_job_);
  }
  run_figures finish() override {
    if constexpr (Held) follow_drains(never);
    hand_out(after_last());
    check_watchdog(last_dispatch_, last_result_);
    return collect(Held ? "drains" : "jobs",
                   {source_.valid_cycles(), after_last() - stages_.stalled(), policy_.ready_cycles(after_last(), core_view{*this}),
                    result_valid_cycles_, sink_ ? sink_->count(0, after_last()) : after_last()},
                   [this](unsigned core) { return policy_.valid_cycles(core); });
  }

 private:
  using base::by_cores_, base::check_watchdog, base::collect, base::cores_, base::dispatches_, base::after_last, base::figures_,
      base::last_dispatch_, base::last_result_, base::leave, base::next_job_, base::results_, base::too_far_apart, base::traverse,
      base::walked_, base::way_;
  using typename base::core_type;

  struct leaving {
    std::uint32_t job = 0;
    std::uint32_t core = 0;
    std::uint64_t latency_cycles = 0;
  };

  /// The cores as a policy sees them.
  struct core_view {
    static constexpr bool known_ahead = !Held;
    schedule& all;

    cycle free_from(unsigned core) const { return all.cores_[core].free_from; }
    /// Sees to it that all drains before cycle c are known.
    void know(cycle c) const {
      if constexpr (Held) {
        if (c > 0) all.follow_drains(c - 1);
      }
    }
  };

  void replay_job(std::uint32_t j) {
    const walked_ray& ray = walked_.rays[j];
    // The source offers, the stages move.
    cycle accepted = source_.next(source_.offered_from());
    for (cycle moves; (moves = stages_.next_move(accepted)) != accepted;) accepted = source_.next(moves);
    source_.accept(accepted);
    figures_.results.last_accepted = accepted;
    const cycle output_from = stages_.output_from(accepted);

    const cycle dispatched = policy_.dispatch(output_from, core_view{*this});
    check_watchdog(last_dispatch_, dispatched);
    stages_.dispatch(output_from, dispatched);
    const unsigned chosen = policy_.core();
    core_type& core = cores_[chosen];
    core.idle_cycles += dispatched - core.free_from + 1;
    dispatches_.jobs.add(dispatched - output_from);
    last_dispatch_ = dispatched;
    way_.check(ray, chosen, j, dispatched);

    const cycle done = traverse(ray, core, accepted, dispatched);
    if constexpr (Held) {
      accepted_[j] = accepted;
      core.dispatch(dispatched + ray.cost, done, j);
      if (core.buffered == never) fill_buffer(core, never);
    } else {
      const cycle buffered = core.drained == never ? done : std::max(done, core.drained + 1);
      // The select meets the buffer every N cycles, core i's in cycle i at first; in each such cycle it is offered.
      const cycle met = core.drained == never ? chosen : core.drained;
      cycle drained = met + by_cores_.quotient(buffered - met + cores_.size()) * cores_.size();
      std::uint64_t offers = 1;
      if (sink_) {
        for (; (sink_->state(drained) & 1) == 0; ++offers) {
          drained += cores_.size();
          if (offers > lfsr::period) throw too_far_apart();
        }
      }
      result_valid_cycles_ += offers;
      core.dispatch(dispatched + ray.cost, done, j);
      core.take(buffered);
      core.drained = drained;
      core.full_cycles += drained - buffered;
      results_.results.add(drained - buffered);
      last_result_ = std::max(last_result_, drained);
      order_.put(drained, {j, chosen, drained - accepted});
    }
    if (order_.span(dispatched) >= 2048) hand_out(dispatched);
  }

  /// Results leave in the order of cycles.
  void hand_out(cycle end) {
    order_.flush(end, [this](cycle c, const leaving& r) { leave(c, r.job, r.core, r.latency_cycles); });
  }

  /// The core's next result comes to the buffer, which the last one left in cycle `drained`, if there was one.
  void fill_buffer(core_type& core, cycle drained) {
    const cycle done = core.offered();
    core.buffered = drained == never ? done : std::max(done, drained + 1);
    core.job = core.take(core.buffered);
    ++outstanding_;
  }

  /// Follows the select as far as cycle `end` and notes what drains.
  void follow_drains(cycle end) {
    while (turn_cycle_ <= end) {
      if (outstanding_ == 0) {
        if (end == never) return;
        turn_ = by_cores_.remainder(turn_ + (end + 1 - turn_cycle_));
        turn_cycle_ = end + 1;
        return;
      }
      core_type& core = cores_[turn_];
      cycle drained = turn_cycle_;
      if (core.buffered != never && core.buffered < turn_cycle_) {
        drained = sink_->next(turn_cycle_);
        if (drained > end) return;  // offered, and taken later
        result_valid_cycles_ += drained - turn_cycle_ + 1;
        core.full_cycles += drained - core.buffered;
        results_.results.add(drained - core.buffered);
        last_result_ = std::max(last_result_, drained);
        order_.put(drained, {core.job, turn_, drained - accepted_[core.job]});
        --outstanding_;
        if (core.offered() != never)
          fill_buffer(core, drained);
        else
          core.buffered = never;
      }
      turn_cycle_ = drained + 1;
      turn_ = turn_ + 1 < cores_.size() ? turn_ + 1 : 0;
    }
  }

  typename Policy::schedule policy_;
  source_schedule source_;
  stages_schedule stages_;
  std::optional<lfsr> sink_;
  cycle_ring<leaving> order_;
  std::uint64_t result_valid_cycles_ = 0;
  // Where drains are followed in time.
  unsigned turn_ = 0;  // the select in `turn_cycle_`
  cycle turn_cycle_ = 0;
  std::uint64_t outstanding_ = 0;  // results in buffers or on their way there
  std::vector<cycle> accepted_;
};

/// The schedule for a design's policy and a run's sink.
template <class Way>
std::unique_ptr<job_schedule> schedule_for(const design& d, const surroundings& s,
                                           const walked_as<typename Way::walked_ray, typename Way::jobs_type>& walked,
                                           const result_handler& handler) {
  const bool always = s.source.valid == source_params::regime::always && s.sink.ready == sink_params::regime::always;
  if constexpr (!Way::overlaps) {
    if (always && d.scheduler_.select == policy_index<cyclic_first_available>)
      return std::make_unique<ring_schedule<Way>>(d, s, walked, handler);
  }
  const bool held = !d.result_manager_.valid_withdrawn && s.sink.ready != sink_params::regime::always;
  return scheduler_policies::with(d.scheduler_.select, [&](auto policy) -> std::unique_ptr<job_schedule> {
    using chosen = typename decltype(policy)::type;
    if (held) return std::make_unique<schedule<true, chosen, Way>>(d, s, walked, handler);
    return std::make_unique<schedule<false, chosen, Way>>(d, s, walked, handler);
  });
}

/// Walks rays as `Way` says:
///
///     class Way::walk;  // copyable, one for each thread
///     void walk::operator()(const job_packet*, std::size_t count, walked_ray* to, jobs_type&);  // adds to what the job manager counts
template <class Way>
class walker final : public ray_walker {
 public:
  template <class... Arguments>
  explicit walker(const Arguments&... arguments) : walk_(arguments...) {}

  std::unique_ptr<walked_rays> room(std::size_t jobs) const override { return std::make_unique<walked_type>(jobs); }
  void walk(const job_packet* jobs, std::size_t first, std::size_t end, walked_rays& to) const override {
    auto& all = static_cast<walked_type&>(to);
    typename Way::walk one = walk_;
    typename Way::jobs_type counted;
    one(jobs + first, end - first, &all.rays[first], counted);
    counted.jobs += end - first;
    all.add(counted);
  }
  std::unique_ptr<job_schedule> schedule(const design& d, const surroundings& s, const walked_rays& walked,
                                         const result_handler& handler) const override {
    return schedule_for<Way>(d, s, static_cast<const walked_type&>(walked), handler);
  }

 private:
  using walked_type = walked_as<typename Way::walked_ray, typename Way::jobs_type>;

  typename Way::walk walk_;
};

}  // namespace rtusim::replaying
