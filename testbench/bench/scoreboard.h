#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "modules/config/report.h"
#include "modules/core_bank/core_bank.h"
#include "modules/formats/packets.h"
#include "modules/timing/channel.h"
#include "testbench/bench/histogram.h"

namespace rtusim {

/// Where the cycles of a ray went, from the edge that accepts its job to the edge at which its result leaves.
struct ray_waits {
  std::uint64_t conversion_cycles = 0;  ///< the job manager's stages
  std::uint64_t dispatch_cycles = 0;    ///< in the job manager, until a core takes the job
  std::uint64_t traversal_cycles = 0;   ///< in the core: cost + 1; of a triangle core with the way through the intersector
  std::uint64_t buffer_cycles = 0;      ///< in the core, until its result buffer is empty
  std::uint64_t result_cycles = 0;      ///< in the result buffer, until the result leaves

  std::uint64_t latency_cycles() const { return conversion_cycles + dispatch_cycles + traversal_cycles + buffer_cycles + result_cycles; }
  ray_waits& operator+=(const ray_waits& w) {
    conversion_cycles += w.conversion_cycles;
    dispatch_cycles += w.dispatch_cycles;
    traversal_cycles += w.traversal_cycles;
    buffer_cycles += w.buffer_cycles;
    result_cycles += w.result_cycles;
    return *this;
  }
  void describe(config::report& r, double rays) const;
};

/// What the results of a run come to.
struct result_figures {
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  cycle last_result = 0;
  cycle last_accepted = 0;
  ray_waits waits;
  histogram latency;
  histogram cost;
  /// Of `testbench/golden`: over job word, hit, cost, cycle and the t of hits, in the order of leaving.
  std::uint64_t checksum = 1469598103934665603u;

  /// From the one that may accept the first job to the one in which the last result leaves.
  std::uint64_t total_cycles() const { return rays == 0 ? 0 : last_result + 1; }

  /// Cycles of a ray's latency beside its cost in which it waits for nobody: the same for every ray.
  std::uint64_t way_cycles() const { return rays == 0 ? 0 : (waits.conversion_cycles + waits.traversal_cycles - cost.sum()) / rays; }

  /// A result leaves in cycle c. Its waits are the caller's to add.
  void count(cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
    ++rays;
    hits += r.hit;
    last_result = c;
    latency.add(latency_cycles);
    cost.add(r.cost);
    mix(r.job_word);
    mix(r.hit);
    mix(r.cost);
    mix(c);
    if (r.hit) mix(static_cast<std::uint32_t>(r.t_hit));
  }

 private:
  void mix(std::uint64_t word) { checksum = (checksum ^ word) * 1099511628211u; }
};

/// Called for each result in the order of leaving, with its cycle and latency. It is of the kind's own type.
using result_handler = std::function<void(cycle, const traversal_result&, std::uint64_t latency_cycles)>;

/// Watches an RTU's channels: that each job comes to one result, in order where order is promised, and how long each part took.
/// A violation is a simulation_error.
class scoreboard final {
 public:
  scoreboard(core_bank& bank, channel<job_packet>& jobs, channel_base& results);

  void on_result(result_handler handler) { handler_ = std::move(handler); }
  /// Called with the number of each job as it is accepted, from 0 on.
  void on_accepted(std::function<void(std::uint32_t)> handler) { accepted_handler_ = std::move(handler); }
  /// Called with the number of each job whose result leaves.
  void on_left(std::function<void(std::uint32_t)> handler) { left_handler_ = std::move(handler); }
  /// At the end: every job has its result.
  void check_complete(std::uint64_t jobs) const;

  const result_figures& figures() const { return figures_; }

 private:
  struct flight {
    std::uint32_t job_word = 0;
    std::uint32_t core = 0;
    cycle accepted = never, dispatched = never, buffered = never;
  };
  friend class channel_base;

  // Transfers of the observed channels.
  void accepted(unsigned, cycle c, const job_packet& p);
  void dispatched(unsigned core, cycle c, const core_job& j);
  void buffered(unsigned core, cycle c, const traversal_result& r);
  void left(unsigned, cycle c, const traversal_result& r);
  flight& in_flight(std::uint32_t sequence) { return flights_[sequence & (flights_.size() - 1)]; }

  const core_bank& bank_;
  cycle job_latency_cycles_ = 0;
  cycle core_latency_cycles_ = 0;
  std::vector<flight> flights_;  // ring by sequence
  std::uint32_t jobs_accepted_ = 0;
  std::uint32_t jobs_dispatched_ = 0;
  result_figures figures_;
  result_handler handler_;
  std::function<void(std::uint32_t)> accepted_handler_;
  std::function<void(std::uint32_t)> left_handler_;
};

}  // namespace rtusim
