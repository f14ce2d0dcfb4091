#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/numeric/divisor.h"
#include "modules/rtu/design.h"
#include "testbench/bench/run_figures.h"
#include "testbench/replay/schedule_parts.h"
#include "testbench/replay/walks.h"

namespace rtusim::replaying {

/// What the schedules of a kind of core have in common: what they count, and the figures that follow. `Way`: what only the kind knows, each
/// ray in its own type:
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
template <class Way>
class counted_schedule : public job_schedule {
 public:
  using walked_ray = typename Way::walked_ray;
  using walked_type = walked_as<walked_ray, typename Way::jobs_type>;

 protected:
  using core_type = core_schedule<typename Way::core_sums, Way::overlaps>;

  counted_schedule(const design& d, const surroundings& s, const walked_type& walked, const result_handler& handler)
      : walked_(walked),
        by_cores_(d.rtu.cores),
        way_(d),
        cores_(d.rtu.cores, core_type(way_.rays_in_flight())),
        watchdog_(s.watchdog_cycles),
        handler_(handler) {
    figures_.clock_mhz = d.rtu.clock_mhz;
  }

  /// Counts a ray on its way through a core, which takes the job in cycle `dispatched`; when its result is there.
  cycle traverse(const walked_ray& ray, core_type& core, cycle accepted, cycle dispatched) {
    core.sums.add(ray);
    auto& waits = figures_.results.waits;
    waits.dispatch_cycles += dispatched - accepted - way_.job_latency_cycles();
    const cycle done = dispatched + ray.cost + 1 + way_.result_latency_cycles();
    waits.traversal_cycles += done - dispatched;
    return done;
  }
  /// A result leaves the unit in cycle c.
  void leave(cycle c, std::uint32_t job, unsigned core, std::uint64_t latency_cycles) {
    const walked_ray& ray = walked_.rays[job];
    typename Way::result_type t;
    t.job_word = ray.job_word;
    t.cost = ray.cost;
    t.hit = ray.hit;
    t.t_hit = ray.t_hit;
    t.core = static_cast<std::uint16_t>(core);
    t.sequence = job;
    figures_.results.count(c, t, latency_cycles);
    if (!handler_) return;
    way_.show(core, ray, t);
    handler_(c, t, latency_cycles);
  }
  void check_watchdog(cycle from, cycle to) const {
    if (to - (from == never ? 0 : from) > watchdog_) throw too_far_apart();
  }
  input_error too_far_apart() const {
    return input_error("--pace replay", fmt::format("transfers more than watchdog.cycles = {} apart", watchdog_),
                       "--pace skipping for such a run");
  }

  /// What remains to be told when all results have left: in how many cycles before it each offer was made.
  struct offered_cycles {
    std::uint64_t job_valid, job_ready;
    std::uint64_t pending_ready;
    std::uint64_t result_valid, result_ready;
  };
  cycle after_last() const { return last_result_ + 1; }
  /// `followed`: for the record; `shown(i)`: in how many cycles a job was shown to core i.
  template <class Shown>
  run_figures collect(std::string_view followed, const offered_cycles& offered, const Shown& shown) {
    figures_.followed = followed;
    const std::uint64_t jobs = walked_.size();
    auto& waits = figures_.results.waits;
    waits.conversion_cycles = jobs * way_.job_latency_cycles();
    for (const auto& core : cores_) waits.buffer_cycles += core.waited_cycles;
    waits.result_cycles = results_.results.cycles;
    const auto channel = [&](std::string name, std::uint64_t transfers, std::uint64_t valid, std::uint64_t ready) {
      figures_.channels.emplace_back(
          std::move(name), channel_stats{transfers, ready - transfers, valid - transfers, after_last() + transfers - valid - ready});
    };
    channel("pending_job", jobs, jobs + dispatches_.jobs.cycles, offered.pending_ready);
    for (unsigned i = 0; i < cores_.size(); ++i) {
      core_type& core = cores_[i];
      core.idle_cycles += cycles_from(core.free_from, 0, after_last());
      channel(fmt::format("core_job_{}", i), core.jobs, shown(i), core.idle_cycles);
    }
    for (unsigned i = 0; i < cores_.size(); ++i)
      channel(fmt::format("core_result_{}", i), cores_[i].jobs, cores_[i].jobs + cores_[i].back_pressured_cycles(),
              after_last() - cores_[i].full_cycles);
    channel("job", jobs, offered.job_valid, offered.job_ready);
    channel("result", jobs, offered.result_valid, offered.result_ready);
    figures_.units = way_.figures(walked_.jobs, dispatches_, cores_, results_, after_last());
    return std::move(figures_);
  }

  const walked_type& walked_;
  divisor by_cores_;
  Way way_;
  std::vector<core_type> cores_;
  scheduler_stats dispatches_;
  result_manager_stats results_;
  run_figures figures_;
  std::uint32_t next_job_ = 0;
  cycle last_dispatch_ = never;
  cycle last_result_ = 0;

 private:
  cycle watchdog_;
  const result_handler& handler_;
};

}  // namespace rtusim::replaying
