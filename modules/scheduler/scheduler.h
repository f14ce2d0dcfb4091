#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "modules/config/error.h"
#include "modules/scheduler/scheduler_params.h"
#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/junction.h"
#include "modules/timing/waveform.h"

namespace rtusim {

/// Hands the job that is offered to one of N cores, within the cycle (Espe 2019, sec. 2.2.5, 6.2.2 and app. C.3).
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

  void arrives(channel_base& job) override;
  std::uint64_t valid_cycles(unsigned which) const override;
  bool points_at(unsigned which, cycle c) const override;
  const Job& payload_at(cycle c) const { return job_in->offered(c); }
  std::optional<unit_timing> timing() const override;
  const scheduler_stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  void connect() override;
  void reset() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  void output_ready(unsigned which, bool ready) override;
  void input_valid(cycle from, cycle to) override;
  unsigned selected(cycle c) const;
  unsigned select() const { return selected(next_edge()); }

  std::vector<channel<Job>*> cores_;
  scheduler_policies::any policy_;
  scheduler_stats stats_;
  std::uint64_t offered_cycles_ = 0;  // of the job that is offered
};

template <class Job>
scheduler<Job>::scheduler(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : junction(name), core_out("core_out", cores), policy_(scheduler_policies::with(p.select, [cores](auto policy) {
        return scheduler_policies::any(std::in_place_type<typename decltype(policy)::type>, cores);
      })) {}

template <class Job>
void scheduler<Job>::connect() {
  own_input(*job_in.operator->());
  for (unsigned i = 0; i < core_out.size(); ++i) {
    cores_.push_back(core_out[i].operator->());
    own_output(*cores_[i], i);
    cores_[i]->drive_from(*this);
  }
}

template <class Job>
void scheduler<Job>::reset() {
  std::visit([this](const auto& policy) { job_in->offer_ready(policy.ready()); }, policy_);
}

template <class Job>
std::optional<unit_timing> scheduler<Job>::timing() const {
  unit_timing t;
  t.valid_passes = t.ready_passes = true;
  return t;
}

template <class Job>
unsigned scheduler<Job>::selected(cycle c) const {
  return std::visit([c](const auto& policy) { return policy.selected(c); }, policy_);
}

template <class Job>
void scheduler<Job>::output_ready(unsigned which, bool ready) {
  job_in->settle_ready();
  std::visit(
      [&](auto& policy) {
        policy.set_ready(which, ready);
        job_in->offer_ready(policy.ready());
      },
      policy_);
}

template <class Job>
void scheduler<Job>::input_valid(cycle from, cycle to) {
  offered_cycles_ += to - from;
  std::visit([from, to](auto& policy) { policy.offered(from, to); }, policy_);
}

template <class Job>
std::uint64_t scheduler<Job>::valid_cycles(unsigned which) const {
  const cycle from = job_in->valid().from;
  return std::visit(
      [&](auto policy) {  // a copy, which hears of the job that is offered now
        if (from < next_edge()) policy.offered(from, next_edge());
        return policy.valid_cycles(which);
      },
      policy_);
}

template <class Job>
void scheduler<Job>::arrives(channel_base& job) {
  stats_.jobs.add(offered_cycles_ - 1);
  offered_cycles_ = 0;
  std::visit(
      [&](auto& policy) {
        const unsigned core = policy.selected(now());
        RTU_CHECK(core, <, cores_.size());
        RTU_CHECK(cores_[core]->ready().asserts(now()), ==, true);
        policy.take(core);
        cores_[core]->carry(static_cast<channel<Job>&>(job).data());
        end_transfer();
        job.offer_ready(policy.ready());
      },
      policy_);
}

template <class Job>
bool scheduler<Job>::points_at(unsigned which, cycle c) const {
  return selected(c) == which;
}

template <class Job>
bool scheduler<Job>::level(const channel_base& port) const {
  if (&port != job_in.operator->()) return job_in->valid_level(next_edge());
  const auto is_ready = [this](unsigned core) { return core_out[core]->ready_level(); };
  return std::visit([&](const auto& policy) { return policy.takes(next_edge(), is_ready); }, policy_);
}

template <class Job>
void scheduler<Job>::trace(waveform& w) const {
  w.add_from<&scheduler::select>(*this, std::string(name()) + ".select", 16);
}

}  // namespace rtusim
