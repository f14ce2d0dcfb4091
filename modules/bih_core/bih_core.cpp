#include "modules/bih_core/bih_core.h"

#include <algorithm>
#include <string>

#include "modules/config/error.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

bih_core::bih_core(const sc_core::sc_module_name& name, const params& p, const bih_memory& memory, unsigned index)
    : unit(name),
      params_(p),
      memory_(memory),
      walk_(p, memory),
      index_(static_cast<std::uint16_t>(index)),
      flights_(p.rays_in_flight),
      machine_(p, memory) {}

void bih_core::connect() {
  latency_cycles_ = intersector_port->latency_cycles();
  params_.result_latency_cycles = latency_cycles_;
  params_.triangle_interval_cycles = intersector_port->interval_cycles();
  walk_ = bih_walk(params_, memory_);
  machine_ = bih_machine(params_, memory_);
}

void bih_core::reset() {
  job_in->offer_ready(offer::always_from(0));
  result_out->offer_valid(offer::none());
}

void bih_core::accept(const triangle_job& job) {
  ray_ = job.ray;
  job_word_ = job.job_word;
  before_ = walk_.registers();
  walk_.rest(now() - std::min(now(), free_from_));
  flight& f = flights_[(oldest_ + in_flight_) % flights_.size()];
  traversal_result& r = f.result = {};
  const std::int64_t distance_unit = intersector_port->distance_unit();
  std::uint64_t nearest = 0;
  outcome_ = walk_(job.ray, job.misses_box, [&](std::uint32_t triangle, std::uint64_t) {
    const triangle_outcome o = intersector_port->intersect(job.ray, triangle);
    if (!o.hit) return no_hit;
    if (!r.hit || o.t < nearest) {
      nearest = o.t;
      r.hit = true;
      r.triangle = triangle;
      r.t_hit = static_cast<std::int64_t>(o.t);
      r.u = static_cast<std::int64_t>(o.u);
      r.v = static_cast<std::int64_t>(o.v);
    }
    return static_cast<std::int64_t>(o.t) * distance_unit;
  });
  if (outcome_.overflow) throw bih_stack_overflow(name(), job.sequence);
  r.job_word = job.job_word;
  r.sequence = job.sequence;
  r.core = index_;
  r.cost = static_cast<std::uint32_t>(outcome_.cycles());
  accepted_ = now();
  free_from_ = now() + r.cost;
  f.available = free_from_ + latency_cycles_ + 1;
  ++in_flight_;
  ++sums_.jobs;
  sums_.hits += r.hit;
  sums_.cost += r.cost;
  sums_.triangles += outcome_.triangles;
  sums_.missed_box += outcome_.visits.cycles() == 1;
  sums_.deepest_stack = std::max<std::uint64_t>(sums_.deepest_stack, outcome_.max_stack);
  sums_.visits += outcome_.visits;
}

void bih_core::edge() {
  const bool taken = result_out->fired();
  const bool accepted = job_in->fired();
  if (!taken && !accepted) return;
  if (taken) {
    oldest_ = oldest_ + 1 < flights_.size() ? oldest_ + 1 : 0;
    --in_flight_;
  }
  if (accepted) accept(job_in->data());
  job_in->offer_ready(in_flight_ < flights_.size() ? offer::always_from(std::max(free_from_, now() + 1)) : offer::none());
  if (in_flight_ == 0) {
    result_out->offer_valid(offer::none());
  } else if (taken || in_flight_ == 1) {
    result_out->drive(oldest().result);
    result_out->offer_valid(offer::always_from(std::max(oldest().available, now() + 1)));
  }
}

void bih_core::settle_registers() {
  const cycle target = domain().next_edge();
  if (accepted_ != never && machine_edge_ <= accepted_) {
    // The machine stands between rays, here or before rays that it never stepped through.
    if (machine_edge_ < accepted_) machine_.rest();
    machine_.inherit(before_);
    machine_.start(ray_);
    machine_edge_ = accepted_ + 1;
  }
  for (; machine_edge_ < std::min(target, free_from_ + 1); ++machine_edge_) step_machine();
  machine_edge_ = target;
  shown_triangle_ = machine_.signals().tri_en ? machine_.signals().tri_num : 0;
}

}  // namespace rtusim
