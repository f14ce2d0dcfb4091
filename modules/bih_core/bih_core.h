#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "modules/bih_core/bih_machine.h"
#include "modules/bih_core/bih_params.h"
#include "modules/bih_core/bih_ray.h"
#include "modules/bih_core/bih_walk.h"
#include "modules/config/report.h"
#include "modules/formats/triangle_job.h"
#include "modules/timing/channel.h"
#include "modules/timing/unit.h"
#include "modules/triangle_unit/triangle_pipeline.h"

namespace rtusim {

/// A traversal core for triangles in a bounding interval hierarchy (Hanika 2007, sec. 3.1, 3.4). It keeps the nearest hit of each ray, the
/// first of those that are equally near.
///
/// Timing: one cycle a state. A job accepted at edge e is in AABB in the cycle after it; ready is 1 again in the ray's last cycle, so
/// that the next ray's AABB follows at once. The ray's end goes through the intersector after its triangles: the result is offered from
/// edge e + cycles + latency + 1 on, in the order of the jobs. A core takes no job while `rays_in_flight` results are not taken.
///
/// The memories answer at once and nothing can disturb a traversal, so the core looks ahead: it walks the whole ray at the accepting
/// edge and steps its state machine only where somebody watches the registers.
class bih_core final : public unit {
 public:
  using params = bih_core_params;
  using job_type = triangle_job;
  using result_type = mesh_result;
  struct stats {
    static constexpr std::string_view sum_name = "bih_core";

    std::uint64_t jobs = 0;
    std::uint64_t hits = 0;
    std::uint64_t cost = 0;
    std::uint64_t missed_box = 0;
    triangle_unit::stats triangles;
    std::uint64_t deepest_stack = 0;
    std::uint64_t idle_cycles = 0;
    bih_visits visits;

    /// One ray's.
    static stats of(const bih_ray& ray);
    stats& operator+=(const stats& other);
    void describe(config::report& r) const;
  };

  rv_in<triangle_job> job_in{"job_in"};
  rv_out<mesh_result> result_out{"result_out"};
  sc_core::sc_port<intersector_interface> intersector_port{"intersector_port"};

  /// `memory` must have passed `check_bih` and outlive the core, `tables` are its; `index`: which core of the RTU it is, for its results.
  bih_core(const sc_core::sc_module_name& name, const params& p, const bih_memory& memory, const std::shared_ptr<const bih_tables>& tables,
           unsigned index);

  void arrives(channel_base& job) override;
  void leaves(channel_base&) override;
  void booked_edge() override { offer_ready(); }
  std::optional<unit_timing> timing() const override;
  /// Figures of all cycles before the next edge; a ray under way counts as far as it has come.
  stats statistics();
  std::unique_ptr<unit_figures> figures() override { return as_figures(statistics()); }

 private:
  struct flight {
    mesh_result result;
    cycle available = never;
  };

  void connect() override;
  void reset() override;
  void settle_registers() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  void accept(const triangle_job& job);
  void offer_ready();
  void offer_oldest();
  flight& oldest() { return flights_[oldest_]; }
  const flight& oldest() const { return flights_[oldest_]; }
  void step_machine();

  params params_;
  const bih_memory& memory_;
  std::shared_ptr<const bih_tables> tables_;
  bih_walk walk_;
  std::uint16_t index_;
  unsigned latency_cycles_ = 0;

  std::vector<flight> flights_;  // a ring of rays_in_flight
  unsigned oldest_ = 0;
  unsigned in_flight_ = 0;
  bool ready_ = true;       // for a job, from the coming cycle on
  cycle accepted_ = never;  // the last job's
  cycle free_from_ = 0;     // the first cycle in which the machine can take the next
  stats sums_;              // of all jobs accepted
  bih_outcome outcome_;     // the last job's

  // The state machine follows the outcome when somebody watches.
  bih_machine machine_;
  quantised_ray ray_;
  bih_kept_registers before_;  // what the job before left, as the last one found it
  cycle machine_edge_ = 0;     // the machine's registers stand just before this edge
  std::uint32_t job_word_ = 0;
  std::uint32_t shown_triangle_ = 0;  // the number that is issued, else 0
};

}  // namespace rtusim
