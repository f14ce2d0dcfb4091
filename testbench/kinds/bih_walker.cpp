#include "testbench/kinds/bih_walker.h"

#include <algorithm>

#include <fmt/format.h>

#include "modules/core_bank/figures_of_bank.h"
#include "modules/triangle_unit/triangle_pipeline.h"

namespace rtusim {
namespace {

/// The core's parameters as its binding to the triangle unit leaves them.
bih_core_params bound(const bih_kind& kind) {
  bih_core_params p = kind.core_with_widths();
  p.result_latency_cycles = triangle_pipeline::latency_cycles_of(kind.intersector_with_words());
  return p;
}

}  // namespace

void bih_way::core_sums::add(const walked_ray& ray) {
  ++jobs;
  hits += ray.hit;
  cost += ray.cost;
  missed_box += ray.cost == 1;
  triangles += {ray.pairs, ray.hits, ray.errors, ray.wrapped};
  deepest_stack = std::max<std::uint64_t>(deepest_stack, ray.max_stack);
  const std::uint64_t others = std::uint64_t{1} + ray.inner + ray.push + ray.pop + ray.leaf;
  visits += {1, ray.cost - others, ray.inner, ray.push, ray.pop, ray.leaf};
}

bih_way::walk::walk(const bih_kind& kind, const bih_memory& hierarchy, const std::shared_ptr<const bih_tables>& tables)
    : set_up_(kind.words, hierarchy.corner),
      walk_(bound(kind), tables),
      intersector_(kind.words, kind.intersector.errata),
      triangles_(hierarchy.triangles),
      lists_(lists_of(*tables, hierarchy, kind.words, kind.intersector.errata)),
      distance_unit_(triangle_pipeline::distance_unit_of(kind.intersector.errata)) {}

bih_way::walked_ray bih_way::walk::one(const job_packet& packet, jobs_type& counted) {
  triangle_job job;
  set_up_(packet, counted.setup, job);
  const bih_ray all = follow(walk_, job.ray, distance_unit_, lists_.get(), [&](std::uint32_t triangle) {
    return intersector_.hit_only(job.ray.position, job.ray.direction, triangles_[triangle]);
  });
  const mesh_result& r = all.result;
  const bih_visits& visits = all.outcome.visits;
  const triangle_unit::stats& pairs = all.triangles;
  const auto word = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
  return {r.t_hit,
          r.u,
          r.v,
          packet.job_word,
          r.cost,
          r.triangle,
          word(visits.inner),
          word(visits.push),
          word(visits.pop),
          word(visits.leaf),
          word(pairs.pairs),
          word(pairs.hits),
          word(pairs.errors),
          word(pairs.wrapped),
          static_cast<std::uint8_t>(all.outcome.max_stack),
          r.hit,
          all.outcome.overflow};
}

bih_way::bih_way(const design& d)
    : job_latency_cycles_(triangle_job_manager::stages_of({d.of<bih_kind>().words, {}})),
      rays_in_flight_(d.of<bih_kind>().core.rays_in_flight),
      result_latency_cycles_(triangle_pipeline::latency_cycles_of(d.of<bih_kind>().intersector_with_words())) {}

void bih_way::check(const walked_ray& ray, unsigned core, std::uint32_t job, cycle) const {
  if (ray.overflow) throw bih_stack_overflow(fmt::format("rtu.core_{}", core), job);
}

void bih_way::show(unsigned, const walked_ray& ray, mesh_result& r) const {
  r.u = ray.u;
  r.v = ray.v;
  r.triangle = ray.triangle;
}

std::vector<named_figures> bih_way::figures(const jobs_type& jobs, const scheduler_stats& dispatches,
                                            const std::vector<replaying::core_schedule<core_sums, overlaps>>& cores,
                                            const result_manager_stats& results, cycle end) const {
  std::vector<bih_core::stats> all;
  for (const auto& core : cores) {
    bih_core::stats& s = all.emplace_back(core.sums);
    s.idle_cycles = end - s.cost;
  }
  return figures_of_bank(jobs, dispatches, all, results);
}

}  // namespace rtusim
