#include "modules/bih_core/bih_core.h"

#include <algorithm>
#include <string>

#include "modules/config/error.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

bih_core::bih_core(const sc_core::sc_module_name& name, const params& p, const bih_memory& memory,
                   const std::shared_ptr<const bih_tables>& tables, unsigned index)
    : unit(name),
      params_(p),
      memory_(memory),
      tables_(tables),
      walk_(p, tables),
      index_(static_cast<std::uint16_t>(index)),
      flights_(p.rays_in_flight),
      machine_(p, memory) {}

void bih_core::connect() {
  latency_cycles_ = intersector_port->latency_cycles();
  params_.result_latency_cycles = latency_cycles_;
  params_.triangle_interval_cycles = intersector_port->interval_cycles();
  walk_ = bih_walk(params_, tables_);
  machine_ = bih_machine(params_, memory_);
}

void bih_core::reset() {
  job_in->offer_ready(offer::always_from(0));
  result_out->offer_valid(offer::none());
}

void bih_core::accept(const triangle_job& job) {
  ray_ = job.ray;
  job_word_ = job.job_word;
  walk_.rest(now() - std::min(now(), free_from_));
  before_ = walk_.registers();
  flight& f = flights_[(oldest_ + in_flight_) % flights_.size()];
  const intersector_interface& intersector = *intersector_port.operator->();
  const bih_ray all = follow(walk_, job.ray, intersector.distance_unit(), intersector.lists(),
                             [&](std::uint32_t triangle) { return intersector.intersect(job.ray, triangle); });
  outcome_ = all.outcome;
  if (outcome_.overflow) throw bih_stack_overflow(name(), job.sequence);
  mesh_result& r = f.result = all.result;
  r.job_word = job.job_word;
  r.sequence = job.sequence;
  r.core = index_;
  accepted_ = now();
  free_from_ = now() + r.cost;
  f.available = free_from_ + latency_cycles_ + 1;
  ++in_flight_;
  sums_ += stats::of(all);
}

void bih_core::arrives(channel_base& job) {
  accept(static_cast<channel<triangle_job>&>(job).data());
  ready_ = false;
  offer_ready();
  if (in_flight_ == 1) offer_oldest();
}

void bih_core::leaves(channel_base&) {
  oldest_ = oldest_ + 1 < flights_.size() ? oldest_ + 1 : 0;
  --in_flight_;
  offer_ready();
  if (in_flight_ != 0) offer_oldest();
}

void bih_core::offer_ready() {
  const bool room = in_flight_ < flights_.size();
  const bool ready = room && now() + 1 >= free_from_;
  if (ready != ready_) {
    ready_ = ready;
    job_in->offer_ready(ready ? offer::always_from(now() + 1) : offer::none());
  }
  // The scheduler wants to hear of a ready core as it becomes so.
  book_edge(room && !ready ? free_from_ - 1 : never);
}

void bih_core::offer_oldest() {
  result_out->drive(oldest().result);
  result_out->offer_valid(offer::always_from(std::max(oldest().available, now() + 1)));
}

void bih_core::step_machine() {
  if (params_.early_out && machine_.signals().tri_en) {
    const triangle_outcome o = intersector_port->intersect(ray_, machine_.signals().tri_num);
    machine_.result(o.hit ? static_cast<std::int64_t>(o.t) * intersector_port->distance_unit() : no_hit);
  }
  machine_.step();
}

void bih_core::settle_registers() {
  const cycle target = next_edge();
  if (accepted_ != never && machine_edge_ <= accepted_) {
    // Either the machine stands where the last job left it, or it never stepped through that job.
    machine_ = bih_machine(params_, memory_);
    machine_.inherit(before_);
    machine_.start(ray_);
    machine_edge_ = accepted_ + 1;
  }
  // Without a ray nothing moves but the address registers, which go to the root, and what is left of a division.
  const cycle moves_until = free_from_ + 1 + params_.triangle_interval_cycles;
  for (; machine_edge_ < target && machine_edge_ <= moves_until; ++machine_edge_) step_machine();
  machine_edge_ = target;
  shown_triangle_ = machine_.signals().tri_en ? machine_.signals().tri_num : 0;
}

bool bih_core::level(const channel_base& port) const {
  if (&port == job_in.operator->()) return (!machine_.busy() || machine_.signals().done) && in_flight_ < flights_.size();
  return in_flight_ != 0 && next_edge() >= oldest().available;
}

std::optional<unit_timing> bih_core::timing() const {
  unit_timing t;
  t.latency_cycles = latency_cycles_ + 1;
  t.interval_cycles = params_.rays_in_flight == 1 ? t.latency_cycles + 1 : 0;
  t.beside_cost = true;
  t.capacity = params_.rays_in_flight;
  return t;
}

bih_core::stats bih_core::statistics() {
  stats s = sums_;
  const cycle next = next_edge();
  if (accepted_ != never && next <= free_from_) {
    settle_registers();
    s.visits -= outcome_.visits;
    s.visits += machine_.outcome().visits;
    s.cost = s.visits.cycles();
  }
  s.idle_cycles = next - s.cost;
  return s;
}

void bih_core::trace(waveform& w) const {
  const std::string n = name();
  const auto& r = machine_.now();
  w.add(r.state, n + ".state", 3);
  w.add(job_word_, n + ".job_word");
  w.add(machine_.signals().done, n + ".done");
  w.add(machine_.signals().tri_en, n + ".tri_en");
  w.add(shown_triangle_, n + ".tri_num", 29);
  w.add(r.stack_pos, n + ".stack_pos", 5);
  w.add(r.address3x, n + ".mem_addr", memory_.address_bits);
  w.add(machine_.signals().we, n + ".we");
  w.add(r.tmin, n + ".tmin", 63);
  w.add(r.tmax, n + ".tmax", 63);
  w.add(r.dist0, n + ".dist0", 63);
  w.add(r.dist1, n + ".dist1", 63);
  w.add(in_flight_, n + ".rays_in_flight", 7);
  w.add(sums_.jobs, n + ".jobs");
  w.add(sums_.hits, n + ".hits");
}

bih_core::stats bih_core::stats::of(const bih_ray& ray) {
  stats s;
  s.jobs = 1;
  s.hits = ray.result.hit;
  s.cost = ray.result.cost;
  s.missed_box = ray.result.cost == 1;
  s.triangles = ray.triangles;
  s.deepest_stack = ray.outcome.max_stack;
  s.visits = ray.outcome.visits;
  return s;
}

bih_core::stats& bih_core::stats::operator+=(const stats& other) {
  jobs += other.jobs;
  hits += other.hits;
  cost += other.cost;
  missed_box += other.missed_box;
  triangles += other.triangles;
  deepest_stack = std::max(deepest_stack, other.deepest_stack);
  idle_cycles += other.idle_cycles;
  visits += other.visits;
  return *this;
}

void bih_core::stats::describe(config::report& r) const {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  r.number("jobs", jobs, "jobs", "rays accepted");
  r.number("hits", hits, "jobs", "rays that hit a triangle");
  r.number("cost", cost, "cycles", "cycles of all traversals");
  r.number("missed_box", missed_box, "jobs", "rays that end in AABB");
  r.number("deepest_stack", deepest_stack, "entries", "most entries that a ray had on the stack");
  r.number("fill", share(triangles.pairs, cost), "", "triangles issued by cycles of traversals: how full the intersector's pipeline was");
  r.group("triangles", [this](config::report& g) { triangles.describe(g); });
  r.group("cycles", [this](config::report& g) {
    g.number("idle", idle_cycles, "cycles", "without a ray");
    g.number("aabb", visits.aabb, "cycles", "in AABB: where the ray leaves the scene's box");
    g.number("node", visits.node, "cycles", "in NODE: reading a node");
    g.number("inner", visits.inner, "cycles", "in INNER: which children the ray meets");
    g.number("push", visits.push, "cycles", "in PUSH: the near child, with the far one on the stack");
    g.number("pop", visits.pop, "cycles", "in POP: back to a far child");
    g.number("leaf", visits.leaf, "cycles", "in LEAF: a triangle a cycle, or waiting for an iterative divider");
  });
}

}  // namespace rtusim
