#include "testbench/kinds/svo_walker.h"

#include <fmt/format.h>

#include "modules/job_manager/job_manager.h"
#include "testbench/replay/schedule.h"

namespace rtusim {
namespace {

/// What a schedule has to know of voxel cores.
class svo_way {
 public:
  using result_type = voxel_result;
  static constexpr unsigned job_latency_cycles = job_manager::latency_cycles;

  explicit svo_way(const design& d) : params_(d.of<svo_kind>().core_with_format()), buses_(d.rtu.cores) {}

  void check(const walked_ray& ray, unsigned core, std::uint32_t job, cycle dispatched) const {
    if (ray.overflow) throw svo_stack_overflow(fmt::format("rtu.core_{}", core), params_.stack_depth, job, ray.job_word, dispatched);
  }
  /// A miss may keep the core's last hit.
  void show(unsigned core, const walked_ray& ray, voxel_result& r) {
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
  std::vector<named_figures> figures(const job_manager::stats& jobs, const scheduler_stats& dispatches,
                                     const std::vector<replaying::core_schedule>& cores, const result_manager_stats& results) const {
    std::vector<svo_core::stats> all;
    for (const auto& core : cores) {
      svo_core::stats& s = all.emplace_back();
      s.jobs = core.jobs;
      s.hits = core.hits;
      s.cost = core.cost;
      s.idle_cycles = core.idle_cycles;
      s.out_cycles = core.jobs + core.waited_cycles;
      s.visits = visits_of_sums(core.jobs, core.cost, core.pushes, core.depth, core.ends);
    }
    return svo_figures(jobs, dispatches, all, results);
  }

 private:
  svo_core_params params_;
  std::vector<svo_result_registers> buses_;
};

}  // namespace

void svo_walker::operator()(const job_packet* jobs, std::size_t count, walked_ray* to, numeric::float_to_fixed_stats& conversion) const {
  traversal_job job;
  for (std::size_t i = 0; i < count; ++i) {
    convert(jobs[i], converter_, conversion, job);
    const svo_outcome o = walk_(job, words_);
    to[i] = {o.t_hit, o.job_word, o.cost, o.pushes, o.depth, o.axis, o.hit, o.overflow};
  }
}

std::unique_ptr<replaying::job_schedule> svo_walker::schedule(const design& d, const surroundings& s, const walked_rays& walked,
                                                              const result_handler& handler) const {
  return replaying::schedule_for<svo_way>(d, s, walked, handler);
}

}  // namespace rtusim
