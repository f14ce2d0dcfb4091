#pragma once

#include <cstdint>

#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/scheduler/policies/policies.h"
#include "modules/timing/channel.h"
#include "modules/timing/junction.h"

namespace rtusim {

struct scheduler_params {
  unsigned select = policy_index<cyclic_first_available>;  ///< which of `scheduler_policies`

  void describe(config::section& s);
};

/// Hands the job that is offered to one of N cores, within the clock (Espe 2019, sec. 2.2.5, 6.2.2 and app. C.3).
///
/// Timing: combinational both ways; the only registers are the policy's. A policy (`policies/policies.h`) decides which core a job is
/// shown to, and so when the scheduler is ready. A new one is a class in a file of `policies/`, a line of the list there, and a test.
template <class Job>
class scheduler final : public junction {
 public:
  using params = scheduler_params;

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

  scheduler_policies::any policy_;
  unsigned shown_select_ = 0;
};

}  // namespace rtusim
