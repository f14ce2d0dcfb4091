#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "modules/core_bank/core_kind.h"
#include "modules/formats/packets.h"
#include "modules/job_manager/job_manager.h"
#include "modules/timing/channel.h"
#include "modules/timing/unit.h"

namespace rtusim::test {

struct probe_params {
  unsigned latency_cycles = 7;

  void describe(config::section& s);
};

/// A core that needs no model: a ray hits if it meets the root cube, where it enters. It takes as long for every ray.
///
/// Timing: a job accepted at edge e has its result offered from edge e + latency + 1 on; a job is taken again in the cycle after the result
/// left.
class probe_core final : public unit {
 public:
  using params = probe_params;
  using job_type = traversal_job;
  using result_type = traversal_result;
  struct stats {
    static constexpr std::string_view sum_name = "probe_core";

    std::uint64_t jobs = 0, hits = 0;
    std::uint64_t idle_cycles = 0, walk_cycles = 0, out_cycles = 0;

    stats& operator+=(const stats& other);
    void describe(config::report& r) const;
  };

  rv_in<traversal_job> job_in{"job_in"};
  rv_out<traversal_result> result_out{"result_out"};

  probe_core(const sc_core::sc_module_name& name, const params& p, unsigned index);

  void arrives(channel_base& job) override;
  void leaves(channel_base& result) override;
  std::optional<unit_timing> timing() const override;
  stats statistics();
  std::unique_ptr<unit_figures> figures() override { return as_figures(statistics()); }

 private:
  enum class state : std::uint8_t { idle, walk, out };

  void reset() override;
  void settle_registers() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;

  params params_;
  traversal_result result_;
  cycle accepted_ = never;  // the last job's
  bool is_done_ = true;     // its result has left
  std::uint64_t jobs_ = 0, hits_ = 0;
  state shown_state_ = state::idle;
};

/// Whether a ray meets the root cube, and the parameter at which it enters.
struct probe_outcome {
  bool hit = false;
  std::int64_t t = 0;
};
probe_outcome probe(const traversal_job& job);

/// Nothing lies in its memories.
class probe_contents final : public memory_contents {};

class probe_kind final : public core_kind {
 public:
  static constexpr std::string_view name = "probe";

  probe_params core;
  job_manager::params jobs;

  std::string_view word() const override { return name; }
  std::unique_ptr<core_kind> copy() const override { return std::make_unique<probe_kind>(*this); }
  void describe_formats(config::schema&, const readers&) override {}
  void describe_units(config::schema& s, const readers& r) override;
  packet_widths packets() const override { return {jobs.format.width()}; }
  unsigned fraction_bits() const override { return jobs.format.fraction_bits; }
  std::string replay_obstacle() const override { return {}; }
  std::vector<named_figures> blank_figures() const override;
  std::unique_ptr<memory_contents> blank_contents() const override;
  std::unique_ptr<core_bank> build(const bank_params& p, const memory_contents& contents) const override;
};

}  // namespace rtusim::test
