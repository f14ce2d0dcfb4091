#include "modules/scheduler/scheduler.h"

#include <numeric>

#include "modules/config/error.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

scheduler::scheduler(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : junction(name),
      core_out("core_out", cores),
      policy_(cores == 1 && p.select == policy::cyclic_first_available ? policy::round_robin : p.select),
      idle_cores_(cores),
      turn_steps_(cores + 1),
      valid_cycles_(cores) {}

void scheduler::connect() {
  own_input(*job_in.operator->());
  for (unsigned i = 0; i < core_out.size(); ++i) {
    own_output(*core_out[i].operator->(), i);
    core_out[i]->drive_from(*this);
  }
}

void scheduler::reset() { job_in->offer_ready(ready_offer()); }

unsigned scheduler::selected(cycle c) const {
  switch (policy_) {
    case policy::cyclic_first_available: return idle_cores_.selected(c);
    case policy::round_robin: return in_line_;
    case policy::first_available: break;
  }
  return idle_cores_.any() ? idle_cores_.lowest() : idle_cores_.lines();
}

offer scheduler::ready_offer() const {
  switch (policy_) {
    case policy::cyclic_first_available: return offer::in(idle_cores_);
    case policy::round_robin: return idle_cores_.line(in_line_) ? offer::always_from(0) : offer::none();
    case policy::first_available: break;
  }
  return idle_cores_.any() ? offer::always_from(0) : offer::none();
}

void scheduler::output_ready(unsigned which, bool ready) {
  job_in->settle_ready();
  idle_cores_.set_line(which, ready);
  job_in->offer_ready(ready_offer());
}

void scheduler::input_valid(cycle from, cycle to) {
  if (policy_ == policy::round_robin) valid_cycles_[in_line_] += to - from;
  if (policy_ != policy::cyclic_first_available) return;
  const unsigned cores = idle_cores_.lines();
  const cycle length = to - from;
  const cycle turns = length < cores ? 0 : length / cores;
  whole_turns_ += turns;
  const unsigned first = idle_cores_.selected(from);
  const unsigned behind = first + static_cast<unsigned>(length - turns * cores);
  ++turn_steps_[first];
  if (behind <= cores) {
    --turn_steps_[behind];
  } else {
    ++turn_steps_[0];
    --turn_steps_[behind - cores];
  }
}

std::uint64_t scheduler::valid_cycles(unsigned which) {
  job_in->settle_valid();
  const auto beyond = std::accumulate(turn_steps_.begin(), turn_steps_.begin() + which + 1, std::int64_t{0});
  return valid_cycles_[which] + whole_turns_ + static_cast<std::uint64_t>(beyond);
}

channel_base& scheduler::pass(cycle c) {
  const unsigned core = selected(c);
  RTU_CHECK(idle_cores_.line(core), ==, true);
  // First available shows a job to a core only in the cycle in which that takes it.
  if (policy_ == policy::first_available) ++valid_cycles_[core];
  if (policy_ == policy::round_robin && idle_cores_.lines() > 1) {
    job_in->settle_ready();
    in_line_ = in_line_ + 1 < idle_cores_.lines() ? in_line_ + 1 : 0;
    job_in->offer_ready(ready_offer());
  }
  return *core_out[core].operator->();
}

bool scheduler::points_at(unsigned which, cycle c) const { return selected(c) == which; }

bool scheduler::level(const channel_base& port) const {
  if (&port != job_in.operator->()) return job_in->valid_level(next_edge());
  if (policy_ == policy::first_available) {
    for (const auto& out : core_out)
      if (out->ready_level()) return true;
    return false;
  }
  return core_out[selected(next_edge())]->ready_level();
}

void scheduler::settle_registers() { shown_select_ = selected(next_edge()); }

void scheduler::trace(waveform& w) const { w.add(shown_select_, std::string(name()) + ".select", 16); }

void scheduler::params::describe(config::section& s) {
  s.choice("policy", select, policy_words(),
           "how a job finds its core: a select that turns every clock, the next core in line, or the ready core with the lowest index");
}

}  // namespace rtusim
