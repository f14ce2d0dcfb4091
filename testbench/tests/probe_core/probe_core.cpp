#include "testbench/tests/probe_core/probe_core.h"

#include "modules/config/error.h"
#include "modules/core_bank/figures_of_bank.h"
#include "modules/core_bank/typed_bank.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim::test {
namespace {

class probe_bank final : public typed_bank<job_manager, probe_core> {
 public:
  probe_bank(const probe_kind& kind, const bank_params& p)
      : typed_bank(kind.jobs, p,
                   [core = kind.core](const char* n, std::size_t i) { return new probe_core(n, core, static_cast<unsigned>(i)); }) {}
};

}  // namespace

void probe_params::describe(config::section& s) {
  s.number("latency_cycles", latency_cycles, {1, 1000}, "cycles", "from a job to its result");
}

probe_outcome probe(const traversal_job& job) {
  const std::int64_t enter = std::max({job.t0[0], job.t0[1], job.t0[2]}), leave = std::min({job.t1[0], job.t1[1], job.t1[2]});
  return {enter < leave && leave > 0, enter};
}

probe_core::probe_core(const sc_core::sc_module_name& name, const params& p, unsigned index) : unit(name), params_(p) {
  result_.core = static_cast<std::uint16_t>(index);
  result_.cost = p.latency_cycles;
}

void probe_core::reset() {
  result_out->drive(result_);
  result_out->offer_valid(offer::none());
  job_in->offer_ready(offer::always_from(0));
}

void probe_core::arrives(channel_base&) {
  const traversal_job& job = job_in->data();
  const probe_outcome o = probe(job);
  result_.job_word = job.job_word;
  result_.sequence = job.sequence;
  result_.hit = o.hit;
  result_.t_hit = o.hit ? o.t : 0;
  accepted_ = now();
  is_done_ = false;
  result_out->offer_valid(offer::always_from(now() + params_.latency_cycles + 1));
}

void probe_core::leaves(channel_base&) {
  ++jobs_;
  hits_ += result_.hit;
  is_done_ = true;
  job_in->offer_ready(offer::always_from(now() + 1));
}

void probe_core::settle_registers() {
  shown_state_ = is_done_ ? state::idle : next_edge() > accepted_ + params_.latency_cycles ? state::out : state::walk;
}

bool probe_core::level(const channel_base& port) const { return shown_state_ == (&port == job_in.operator->() ? state::idle : state::out); }

std::optional<unit_timing> probe_core::timing() const {
  unit_timing t;
  t.latency_cycles = 1;
  t.interval_cycles = 2;
  t.beside_cost = true;
  t.capacity = 1;
  return t;
}

probe_core::stats probe_core::statistics() {
  stats s;
  s.jobs = jobs_;
  s.hits = hits_;
  const channel_stats in = job_in->stats(), out = result_out->stats();
  s.idle_cycles = in.transferred + in.starved;
  s.out_cycles = out.transferred + out.back_pressured;
  s.walk_cycles = in.back_pressured + in.idle - s.out_cycles;
  return s;
}

void probe_core::trace(waveform& w) const {
  const std::string n = name();
  w.add(shown_state_, n + ".state", 2);
  w.add(jobs_, n + ".jobs");
}

probe_core::stats& probe_core::stats::operator+=(const stats& other) {
  jobs += other.jobs;
  hits += other.hits;
  idle_cycles += other.idle_cycles;
  walk_cycles += other.walk_cycles;
  out_cycles += other.out_cycles;
  return *this;
}

void probe_core::stats::describe(config::report& r) const {
  r.number("jobs", jobs, "jobs", "rays tried");
  r.number("hits", hits, "jobs", "rays that met the root cube");
  r.group("cycles", [this](config::report& g) {
    g.number("idle", idle_cycles, "cycles", "without a job");
    g.number("walk", walk_cycles, "cycles", "at work");
    g.number("out", out_cycles, "cycles", "a result waits to be taken");
  });
}

void probe_kind::describe_units(config::schema& s, const readers& r) {
  s.add("probe_core", core, r.home);
  s.read_when({"probe_core"}, r.is_chosen, "rtu.core = probe");
}

std::vector<named_figures> probe_kind::blank_figures() const {
  return figures_of_bank(job_manager::stats{}, {}, std::vector<probe_core::stats>(1), {});
}

std::unique_ptr<memory_contents> probe_kind::blank_contents() const { return std::make_unique<probe_contents>(); }

std::unique_ptr<core_bank> probe_kind::build(const bank_params& p, const memory_contents&) const {
  return std::make_unique<probe_bank>(*this, p);
}

}  // namespace rtusim::test
