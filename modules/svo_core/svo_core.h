#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "modules/config/report.h"
#include "modules/formats/packets.h"
#include "modules/memory/memory.h"
#include "modules/svo_core/svo_ahead.h"
#include "modules/svo_core/svo_machine.h"
#include "modules/svo_core/svo_params.h"
#include "modules/svo_core/svo_walk.h"
#include "modules/timing/channel.h"
#include "modules/timing/unit.h"

namespace rtusim {

/// A traversal core for sparse voxel octrees: one ray after the other (Espe 2019, sec. 4.1, 6.2.3, 7.2.4).
///
/// Timing: one cycle a state. Ready in IDLE; a job accepted at edge e is in OUT, its result valid, from edge e + cost + 1 on until
/// it is taken, and the core is IDLE again from the edge after that on.
///
/// The memory answers at once and nothing can disturb a traversal, so the core looks ahead: it walks the whole ray at the accepting
/// edge and steps its state machine only where somebody watches the registers.
class svo_core final : public unit, public memory_reader {
 public:
  using params = svo_core_params;
  using job_type = traversal_job;
  using result_type = voxel_result;
  struct stats {
    static constexpr std::string_view sum_name = "svo_core";

    std::uint64_t jobs = 0;
    std::uint64_t hits = 0;
    std::uint64_t cost = 0;
    std::uint64_t idle_cycles = 0;
    std::uint64_t out_cycles = 0;
    svo_visits visits;

    /// A descriptor's address is set in INIT and in POP.
    std::uint64_t fetches() const { return visits.init + visits.pop; }

    stats& operator+=(const stats& other);
    void describe(config::report& r) const;
  };

  rv_in<traversal_job> job_in{"job_in"};
  rv_out<voxel_result> result_out{"result_out"};
  sc_core::sc_port<memory_interface> memory_port{"memory_port"};

  /// `index`: which core of the RTU it is, for its results.
  svo_core(const sc_core::sc_module_name& name, const params& p, unsigned index);

  /// Its jobs are walked ahead of it, and come with their own numbers and no words but those that pass through.
  void follow(svo_ahead& ahead) { ahead_ = &ahead; }
  void arrives(channel_base& job) override;
  void leaves(channel_base&) override;
  std::optional<unit_timing> timing() const override;
  /// Figures of all cycles before the next edge.
  stats statistics();
  std::unique_ptr<unit_figures> figures() override { return as_figures(statistics()); }
  std::uint64_t fetches() override { return statistics().fetches(); }

 private:
  void connect() override;
  void reset() override;
  void settle_registers() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  void accept(const traversal_job& job);
  void walk(const traversal_job& job);
  void start_machine();

  params params_;
  svo_walk walk_;
  svo_ahead* ahead_ = nullptr;
  word_view memory_;
  voxel_result result_;
  svo_result_registers bus_;  // what the result bus keeps
  svo_outcome outcome_;
  cycle accepted_ = never;  // the last job's
  cycle released_ = never;  // its result's, once it is taken
  std::uint64_t jobs_ = 0;
  std::uint64_t hits_ = 0;
  std::uint64_t cost_ = 0;
  std::uint64_t pushes_ = 0;  // with those above: of the jobs whose result was taken
  std::uint64_t depth_ = 0;
  std::uint64_t ends_ = 0;

  // The state machine follows the outcome when somebody watches.
  svo_machine machine_;
  traversal_job job_;
  std::optional<std::uint32_t> sequence_before_;  // of the job before, and what that left
  std::uint8_t child_before_ = 0;
  std::uint8_t depth_before_ = 0;
  svo_result_registers bus_before_;
  cycle machine_edge_ = 0;  // the machine's registers stand just before this edge
};

}  // namespace rtusim
