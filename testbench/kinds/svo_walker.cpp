#include "testbench/kinds/svo_walker.h"

#include <fmt/format.h>

namespace rtusim {

void svo_way::check(const walked_ray& ray, unsigned core, std::uint32_t job, cycle dispatched) const {
  if (ray.overflow) throw svo_stack_overflow(fmt::format("rtu.core_{}", core), params_.stack_depth, job, ray.job_word, dispatched);
}

void svo_way::show(unsigned core, const walked_ray& ray, voxel_result& r) {
  svo_outcome o;
  o.hit = ray.hit;
  o.t_hit = ray.t_hit;
  o.axis = ray.axis;
  svo_result_registers& bus = buses_[core];
  bus.take(o, ray.job_word >> job_id_bits & 7, params_);
  r.t_hit = bus.t_hit;
  r.normal_axis = bus.axis;
  r.normal_sign = bus.sign;
}

std::vector<named_figures> svo_way::figures(const jobs_type& jobs, const scheduler_stats& dispatches,
                                            const std::vector<replaying::core_schedule<core_sums, overlaps>>& cores,
                                            const result_manager_stats& results, cycle) const {
  std::vector<svo_core::stats> all;
  for (const auto& core : cores) {
    const core_sums& sums = core.sums;
    svo_core::stats& s = all.emplace_back();
    s.jobs = core.jobs;
    s.hits = sums.hits;
    s.cost = sums.cost;
    s.idle_cycles = core.idle_cycles;
    s.out_cycles = core.jobs + core.waited_cycles;
    s.visits = visits_of_sums(core.jobs, sums.cost, sums.pushes, sums.depth, sums.ends);
  }
  return svo_figures(jobs, dispatches, all, results);
}

}  // namespace rtusim
