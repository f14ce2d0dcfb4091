#pragma once

#include <cstdint>
#include <vector>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/timing/channel.h"
#include "modules/timing/junction.h"
#include "modules/timing/rotating_select.h"

namespace rtusim {

struct scheduler_params {
  enum class policy : std::uint8_t { cyclic_first_available, round_robin, first_available };
  static config::word_list policy_words() { return {"cyclic_first_available", "round_robin", "first_available"}; }

  policy select = policy::cyclic_first_available;
  void describe(config::section& s);
};

/// Hands the job that is offered to one of N cores, within the clock (Espe 2019, sec. 2.2.5, 6.2.2 and app. C.3).
///
/// Timing: combinational both ways; the only register is the select. Policies:
/// - cyclic first available: the select turns by one every clock; the job goes where it points if that core is ready.
/// - round robin: the select points at the next core in line and moves on when that core takes a job.
/// - first available: no select; of the cores that are ready, the one with the lowest index.
template <class Job>
class scheduler final : public junction {
 public:
  using params = scheduler_params;
  using policy = params::policy;

  rv_in<Job> job_in{"job_in"};
  sc_core::sc_vector<rv_out<Job>> core_out;

  scheduler(const sc_core::sc_module_name& name, const params& p, unsigned cores);

  std::uint64_t valid_cycles(unsigned which) override;
  bool points_at(unsigned which, cycle c) const override;
  const Job& payload_at(cycle c) const { return job_in->offered(c); }

 private:
  void connect() override;
  void reset() override;
  void settle_registers() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  void output_ready(unsigned which, bool ready) override;
  void input_valid(cycle from, cycle to) override;
  channel_base& pass(cycle c) override;
  unsigned selected(cycle c) const;
  offer ready_offer() const;

  policy policy_;                            // with one core the select has nowhere to turn to: as round robin
  rotating_select idle_cores_;               // the select register of the cyclic policy, and which cores are ready
  unsigned in_line_ = 0;                     // the select register of round robin
  std::uint64_t whole_turns_ = 0;            // valid cycles that every output has had
  std::vector<std::int64_t> turn_steps_;     // and those beyond: the difference from one output to the next
  std::vector<std::uint64_t> valid_cycles_;  // by output, for the policies whose select stands still
  unsigned shown_select_ = 0;
};

}  // namespace rtusim
