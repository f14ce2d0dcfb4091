#include "modules/scheduler/scheduler.h"

#include <string>
#include <variant>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/formats/triangle_job.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

template <class Job>
scheduler<Job>::scheduler(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : junction(name), core_out("core_out", cores), policy_(scheduler_policies::with(p.select, [cores](auto policy) {
        return scheduler_policies::any(std::in_place_type<typename decltype(policy)::type>, cores);
      })) {}

template <class Job>
void scheduler<Job>::connect() {
  own_input(*job_in.operator->());
  for (unsigned i = 0; i < core_out.size(); ++i) {
    own_output(*core_out[i].operator->(), i);
    core_out[i]->drive_from(*this);
  }
}

template <class Job>
void scheduler<Job>::reset() {
  std::visit([this](const auto& policy) { job_in->offer_ready(policy.ready()); }, policy_);
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
  std::visit([from, to](auto& policy) { policy.offered(from, to); }, policy_);
}

template <class Job>
std::uint64_t scheduler<Job>::valid_cycles(unsigned which) {
  job_in->settle_valid();
  return std::visit([which](const auto& policy) { return policy.valid_cycles(which); }, policy_);
}

template <class Job>
channel_base& scheduler<Job>::pass(cycle c) {
  return std::visit(
      [&](auto& policy) -> channel_base& {
        const unsigned core = policy.selected(c);
        RTU_CHECK(core, <, core_out.size());
        channel_base& out = *core_out[core].operator->();
        RTU_CHECK(out.ready().asserts(c), ==, true);
        if (policy.take(core)) job_in->offer_ready(policy.ready());
        return out;
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
void scheduler<Job>::settle_registers() {
  shown_select_ = selected(next_edge());
}

template <class Job>
void scheduler<Job>::trace(waveform& w) const {
  w.add(shown_select_, std::string(name()) + ".select", 16);
}

void scheduler_params::describe(config::section& s) {
  const auto meanings = scheduler_policies::meanings();
  s.choice("policy", select, scheduler_policies::names(),
           fmt::format("how a job finds its core: {}, or {}", fmt::join(meanings.begin(), meanings.end() - 1, ", "), meanings.back()));
}

template class scheduler<traversal_job>;
template class scheduler<triangle_job>;

}  // namespace rtusim
