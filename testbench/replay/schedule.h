#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/rtu/design.h"
#include "modules/scheduler/policies/policies.h"
#include "modules/timing/divisor.h"
#include "testbench/bench/run_figures.h"
#include "testbench/replay/schedule_parts.h"
#include "testbench/replay/walks.h"

namespace rtusim::replaying {

/// One replay. `Held`: an offered result stays and the sink is not always ready. `Policy`: of the scheduler. `Way`: what only the kind of
/// core knows, each ray in its own type:
///
///     using walked_ray = ...;                          // a ray's walk, with `job_word`, `cost`, `hit`, `t_hit`; no initial values
///     using jobs_type = ...;                           // what the job manager counts, with `jobs`
///     using result_type = ...;                         // of a core
///     using core_sums = ...;                           // what only these cores count, with `add(const walked_ray&)`
///     static constexpr bool overlaps = ...;            // whether a core takes a job while results of others are on their way,
///     unsigned rays_in_flight() const;                 // and how many
///     unsigned result_latency_cycles() const;          // from a ray's end to its result, beside the one of its register
///     explicit Way(const design&);
///     unsigned job_latency_cycles() const;             // from accepted to dispatched at the earliest
///     void check(const walked_ray&, unsigned core, std::uint32_t job, cycle dispatched) const;  // throws for a walk that is a fault
///     void show(unsigned core, const walked_ray&, result_type&);  // what the result bus carries, in the order of leaving
///     /// Of the bank's units, in their order, after so many cycles.
///     std::vector<named_figures> figures(const jobs_type&, const scheduler_stats&, const std::vector<core_schedule<core_sums, overlaps>>&,
///                                        const result_manager_stats&, cycle end) const;
template <bool Held, class Policy, class Way>
class schedule final : public job_schedule {
 public:
  using walked_ray = typename Way::walked_ray;
  using walked_type = walked_as<walked_ray, typename Way::jobs_type>;

  schedule(const design& d, const surroundings& s, const walked_type& walked, const result_handler& handler)
      : watchdog_(s.watchdog_cycles),
        policy_(d.rtu.cores),
        walked_(walked),
        handler_(handler),
        by_cores_(d.rtu.cores),
        way_(d),
        cores_(d.rtu.cores, core_type(way_.rays_in_flight())),
        source_(s.source),
        stages_(way_.job_latency_cycles()),
        accepted_(Held ? walked.size() : 0) {
    if (s.sink.ready == sink_params::regime::lfsr) sink_.emplace(s.sink.seed);
    figures_.clock_mhz = d.rtu.clock_mhz;
  }

  /// Follows the jobs before `end`, which are walked.
  void advance(std::size_t end) override {
    for (; next_job_ < end; ++next_job_) replay_job(next_job_);
  }
  run_figures finish() override {
    if constexpr (Held) follow_drains(never);
    order_.flush(last_result_ + 1, [this](cycle c, const leaving_order::result& r) { leave(c, r); });
    check_watchdog(last_dispatch_, last_result_);
    collect();
    return std::move(figures_);
  }

 private:
  using core_type = core_schedule<typename Way::core_sums, Way::overlaps>;

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

    core.sums.add(ray);
    auto& waits = figures_.results.waits;
    waits.dispatch_cycles += dispatched - accepted - way_.job_latency_cycles();
    const cycle done = dispatched + ray.cost + 1 + way_.result_latency_cycles();
    waits.traversal_cycles += done - dispatched;

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
      order_.add(drained, {j, chosen, drained - accepted});
    }
    if (order_.span(dispatched) >= leaving_order::batch)
      order_.flush(dispatched, [this](cycle c, const leaving_order::result& r) { leave(c, r); });
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
        order_.add(drained, {core.job, turn_, drained - accepted_[core.job]});
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

  void leave(cycle c, const leaving_order::result& r) {
    const walked_ray& ray = walked_.rays[r.job];
    typename Way::result_type t;
    t.job_word = ray.job_word;
    t.cost = ray.cost;
    t.hit = ray.hit;
    t.t_hit = ray.t_hit;
    t.core = static_cast<std::uint16_t>(r.core);
    t.sequence = r.job;
    figures_.results.count(c, t, r.latency_cycles);
    if (!handler_) return;
    way_.show(r.core, ray, t);
    handler_(c, t, r.latency_cycles);
  }

  input_error too_far_apart() const {
    return input_error("--pace replay", fmt::format("transfers more than watchdog.cycles = {} apart", watchdog_),
                       "--pace skipping for such a run");
  }
  void check_watchdog(cycle from, cycle to) const {
    if (to - (from == never ? 0 : from) > watchdog_) throw too_far_apart();
  }

  /// The figures that follow from the sums.
  void collect() {
    const cycle end = last_result_ + 1;
    const std::uint64_t jobs = walked_.size();
    auto& waits = figures_.results.waits;
    waits.conversion_cycles = jobs * way_.job_latency_cycles();
    for (const auto& core : cores_) waits.buffer_cycles += core.waited_cycles;
    const auto channel = [&](std::string name, std::uint64_t transfers, std::uint64_t valid, std::uint64_t ready) {
      figures_.channels.emplace_back(std::move(name),
                                     channel_stats{transfers, ready - transfers, valid - transfers, end + transfers - valid - ready});
    };
    waits.result_cycles = results_.results.cycles;
    channel("pending_job", jobs, jobs + dispatches_.jobs.cycles, policy_.ready_cycles(end, core_view{*this}));
    for (unsigned i = 0; i < cores_.size(); ++i) {
      core_type& core = cores_[i];
      core.idle_cycles += cycles_from(core.free_from, 0, end);
      channel(fmt::format("core_job_{}", i), core.jobs, policy_.valid_cycles(i), core.idle_cycles);
    }
    for (unsigned i = 0; i < cores_.size(); ++i)
      channel(fmt::format("core_result_{}", i), cores_[i].jobs, cores_[i].jobs + cores_[i].back_pressured_cycles(),
              end - cores_[i].full_cycles);
    channel("job", jobs, source_.valid_cycles(), end - stages_.stalled());
    channel("result", jobs, result_valid_cycles_, sink_ ? sink_->count(0, end) : end);

    figures_.units = way_.figures(walked_.jobs, dispatches_, cores_, results_, end);
  }

  cycle watchdog_;
  typename Policy::schedule policy_;
  const walked_type& walked_;
  const result_handler& handler_;
  scheduler_stats dispatches_;
  result_manager_stats results_;
  divisor by_cores_;
  Way way_;
  std::vector<core_type> cores_;
  source_schedule source_;
  stages_schedule stages_;
  std::optional<lfsr> sink_;
  leaving_order order_;
  run_figures figures_;

  std::uint32_t next_job_ = 0;
  cycle last_dispatch_ = never;
  cycle last_result_ = 0;
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
