#include "modules/svo_core/svo_core.h"

#include <algorithm>
#include <utility>

#include "modules/config/error.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

svo_core::svo_core(const sc_core::sc_module_name& name, const params& p, unsigned index)
    : unit(name), params_(p), walk_(p), machine_(p, {}) {
  result_.core = static_cast<std::uint16_t>(index);
}

void svo_core::connect() {
  memory_ = memory_port->words();
  memory_port->attach(*this);
  machine_ = svo_machine(params_, memory_);
}

void svo_core::reset() {
  result_out->drive(result_);
  result_out->offer_valid(offer::none());
  job_in->offer_ready(offer::always_from(0));
}

void svo_core::walk(const traversal_job& job) {
  if (ahead_ == nullptr) {
    outcome_ = walk_(job, memory_);
    return;
  }
  const svo_walked& w = ahead_->walked(job.sequence);
  outcome_.hit = w.hit;
  outcome_.t_hit = w.t_hit;
  outcome_.axis = w.axis;
  outcome_.cost = w.cost;
  outcome_.pushes = w.pushes;
  outcome_.depth = w.depth;
  outcome_.overflow = w.overflow;
}

void svo_core::accept(const traversal_job& job) {
  if (accepted_ != never) sequence_before_ = job_.sequence;
  if (ahead_ == nullptr)
    job_ = job;
  else
    job_.sequence = job.sequence;  // the rest when somebody watches
  child_before_ = outcome_.child;
  depth_before_ = outcome_.depth;
  bus_before_ = bus_;
  walk(job);
  if (outcome_.overflow) throw svo_stack_overflow(name(), params_.stack_depth, job.sequence, job.job_word, now());
  bus_.take(outcome_, job.direction_bits(), params_);
  result_.job_word = job.job_word;
  result_.cost = outcome_.cost;
  result_.t_hit = bus_.t_hit;
  result_.hit = outcome_.hit;
  result_.normal_axis = bus_.axis;
  result_.normal_sign = bus_.sign;
  result_.sequence = job.sequence;
  accepted_ = now();
  released_ = never;
}

void svo_core::arrives(channel_base& job) {
  accept(static_cast<channel<traversal_job>&>(job).data());
  result_out->offer_valid(offer::always_from(now() + outcome_.cost + 1));
}

void svo_core::leaves(channel_base&) {
  ++jobs_;
  hits_ += outcome_.hit;
  cost_ += outcome_.cost;
  pushes_ += outcome_.pushes;
  depth_ += outcome_.depth;
  ends_ += !outcome_.hit && outcome_.cost > 2;
  released_ = now();
  job_in->offer_ready(offer::always_from(now() + 1));
}

void svo_core::start_machine() {
  // Either the machine stands where the last job left it, or it never stepped through that job.
  if (ahead_ != nullptr) {
    if (sequence_before_) child_before_ = walk_(ahead_->job(*sequence_before_), memory_).child;
    job_ = ahead_->job(job_.sequence);
  }
  machine_.inherit(child_before_, depth_before_, bus_before_);
  machine_.accept(job_);
}

void svo_core::settle_registers() {
  const cycle target = next_edge();
  const cycle from = std::exchange(machine_edge_, target);
  if (accepted_ == never || from == target) return;
  cycle edge = from;
  if (edge <= accepted_) {
    start_machine();
    edge = accepted_ + 1;
  }
  const cycle in_out = accepted_ + 1 + outcome_.cost;
  for (const cycle end = std::min(target, in_out); edge < end; ++edge) machine_.step();
  // In OUT nothing moves, and in IDLE nothing after the edge that clears the cost.
  if (released_ >= target || edge > released_ + 1) return;
  if (edge <= released_) machine_.release();
  if (released_ + 1 < target) machine_.step();
}

bool svo_core::level(const channel_base& port) const {
  const svo_state state = machine_.now().state;
  if (&port == job_in.operator->()) return state == svo_state::idle;
  if (state != svo_state::out) return false;
  const auto& m = machine_.now();
  RTU_CHECK(m.cost, ==, result_.cost);
  RTU_CHECK(m.hit, ==, result_.hit);
  RTU_CHECK(m.result.t_hit, ==, result_.t_hit);
  RTU_CHECK(static_cast<int>(m.result.axis), ==, static_cast<int>(result_.normal_axis));
  RTU_CHECK(static_cast<int>(m.result.sign), ==, static_cast<int>(result_.normal_sign));
  return true;
}

std::optional<unit_timing> svo_core::timing() const {
  unit_timing t;
  t.latency_cycles = 1;
  t.interval_cycles = 2;
  t.beside_cost = true;
  t.capacity = 1;
  return t;
}

svo_core::stats svo_core::statistics() {
  stats s;
  s.jobs = jobs_;
  s.hits = hits_;
  s.cost = cost_;
  s.visits = visits_of_sums(jobs_, cost_, pushes_, depth_, ends_);
  if (accepted_ != never && released_ == never) {
    settle_registers();
    s.visits += machine_.visits();
  }
  const channel_stats in = job_in->stats();
  const channel_stats out = result_out->stats();
  s.idle_cycles = in.transferred + in.starved;
  s.out_cycles = out.transferred + out.back_pressured;
  return s;
}

void svo_core::trace(waveform& w) const {
  const std::string n = name();
  const auto& r = machine_.now();
  w.add(r.state, n + ".state", 3);
  w.add(r.cost, n + ".cost");
  w.add(r.job_word, n + ".job_word");
  w.add(r.top.entry, n + ".entry_idx");
  w.add(r.address, n + ".mem_addr");
  w.add_from<&svo_machine::memory_data>(machine_, n + ".mem_data", 32);
  w.add(r.top.child, n + ".cur_child_idx", 3);
  w.add(r.stack_size, n + ".stack_idx");
  for (unsigned i = 0; i < 3; ++i) {
    const char axis = "xyz"[i];
    w.add(r.top.t0[i], n + ".t0" + axis, params_.format.width());
    w.add(r.top.tm[i], n + ".tm" + axis, params_.format.width());
    w.add(r.top.t1[i], n + ".t1" + axis, params_.format.width());
  }
  w.add(jobs_, n + ".jobs");
  w.add(hits_, n + ".hits");
}

svo_core::stats& svo_core::stats::operator+=(const stats& other) {
  jobs += other.jobs;
  hits += other.hits;
  cost += other.cost;
  idle_cycles += other.idle_cycles;
  out_cycles += other.out_cycles;
  visits += other.visits;
  return *this;
}

void svo_core::stats::describe(config::report& r) const {
  r.number("jobs", jobs, "jobs", "rays traversed");
  r.number("hits", hits, "jobs", "rays that hit a voxel");
  r.number("cost", cost, "cycles", "cycles of all traversals: INIT, EVAL, NEXT, PUSH and POP");
  r.group("cycles", [this](config::report& g) {
    g.number("idle", idle_cycles, "cycles", "in IDLE: no job");
    g.number("init", visits.init, "cycles", "in INIT: the first child of a cube");
    g.number("eval", visits.eval, "cycles", "in EVAL: is the child filled, empty or divided");
    g.number("next", visits.next, "cycles", "in NEXT: the child that the ray enters next");
    g.number("push", visits.push, "cycles", "in PUSH: down into a child");
    g.number("pop", visits.pop, "cycles", "in POP: up again");
    g.number("out", out_cycles, "cycles", "in OUT: a result waits to be taken");
  });
}

}  // namespace rtusim
