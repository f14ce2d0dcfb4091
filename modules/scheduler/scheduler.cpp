#include "modules/scheduler/scheduler.h"

#include <numeric>

#include "modules/config/error.h"
#include "modules/formats/triangle_job.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

template <class Job>
scheduler<Job>::scheduler(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : junction(name),
      core_out("core_out", cores),
      policy_(cores == 1 && p.select == policy::cyclic_first_available ? policy::round_robin : p.select),
      idle_cores_(cores),
      turn_steps_(cores + 1),
      valid_cycles_(cores) {}

template <class Job>
void scheduler<Job>::connect() {
  own_input(*job_in.operator->());
  for (unsigned i = 0; i < core_out.size(); ++i) {
    own_output(*core_out[i].operator->(), i);
    core_out[i]->drive_from(*this);
  }
}

template <class Job>
void scheduler<Job>::reset() { job_in->offer_ready(ready_offer()); }

template <class Job>
unsigned scheduler<Job>::selected(cycle c) const {
  switch (policy_) {
    case policy::cyclic_first_available: return idle_cores_.selected(c);
    case policy::round_robin: return in_line_;
    case policy::first_available: break;
  }
  return idle_cores_.any() ? idle_cores_.lowest() : idle_cores_.lines();
}

template <class Job>
offer scheduler<Job>::ready_offer() const {
  switch (policy_) {
    case policy::cyclic_first_available: return offer::in(idle_cores_);
    case policy::round_robin: return idle_cores_.line(in_line_) ? offer::always_from(0) : offer::none();
    case policy::first_available: break;
  }
  return idle_cores_.any() ? offer::always_from(0) : offer::none();
}

template <class Job>
void scheduler<Job>::output_ready(unsigned which, bool ready) {
  job_in->settle_ready();
  idle_cores_.set_line(which, ready);
  job_in->offer_ready(ready_offer());
}

template <class Job>
void scheduler<Job>::input_valid(cycle from, cycle to) {
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

template <class Job>
std::uint64_t scheduler<Job>::valid_cycles(unsigned which) {
  job_in->settle_valid();
  const auto beyond = std::accumulate(turn_steps_.begin(), turn_steps_.begin() + which + 1, std::int64_t{0});
  return valid_cycles_[which] + whole_turns_ + static_cast<std::uint64_t>(beyond);
}

template <class Job>
channel_base& scheduler<Job>::pass(cycle c) {
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

template <class Job>
bool scheduler<Job>::points_at(unsigned which, cycle c) const { return selected(c) == which; }

template <class Job>
bool scheduler<Job>::level(const channel_base& port) const {
  if (&port != job_in.operator->()) return job_in->valid_level(next_edge());
  if (policy_ == policy::first_available) {
    for (const auto& out : core_out)
      if (out->ready_level()) return true;
    return false;
  }
  return core_out[selected(next_edge())]->ready_level();
}

template <class Job>
void scheduler<Job>::settle_registers() { shown_select_ = selected(next_edge()); }

template <class Job>
void scheduler<Job>::trace(waveform& w) const { w.add(shown_select_, std::string(name()) + ".select", 16); }

void scheduler_params::describe(config::section& s) {
  s.choice("policy", select, policy_words(),
           "how a job finds its core: a select that turns every clock, the next core in line, or the ready core with the lowest index");
}

template class scheduler<traversal_job>;
template class scheduler<triangle_job>;

}  // namespace rtusim
