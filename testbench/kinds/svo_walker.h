#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/svo_core/svo_batch.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/replay/schedule.h"

namespace rtusim {

/// What a replay has to know of voxel cores: see `replaying::schedule` and `replaying::walker`.
class svo_way {
 public:
  using walked_ray = svo_walked;
  using jobs_type = job_manager::stats;
  using result_type = voxel_result;
  struct core_sums {
    std::uint64_t hits = 0, cost = 0, pushes = 0, depth = 0, ends = 0;

    void add(const walked_ray& ray) {
      hits += ray.hit;
      cost += ray.cost;
      pushes += ray.pushes;
      depth += ray.depth;
      ends += !ray.hit && ray.cost > 2;
    }
  };
  static constexpr bool overlaps = false;

  /// Converts jobs and walks them through an octree, which must outlive this.
  class walk {
   public:
    walk(const svo_kind& kind, const std::vector<std::uint32_t>& octree)
        : batch_(kind.core_with_format(), kind.conversion, view_of(octree, kind.memory_)) {}

    void operator()(const job_packet* jobs, std::size_t count, walked_ray* to, jobs_type& counted) const {
      batch_(jobs, count, to, counted.conversion);
    }

   private:
    svo_batch batch_;
  };

  explicit svo_way(const design& d) : params_(d.of<svo_kind>().core_with_format()), buses_(d.rtu.cores) {}

  unsigned job_latency_cycles() const { return job_manager::latency_cycles; }
  unsigned rays_in_flight() const { return 1; }
  unsigned result_latency_cycles() const { return 0; }
  void check(const walked_ray& ray, unsigned core, std::uint32_t job, cycle dispatched) const;
  /// A miss may keep the core's last hit.
  void show(unsigned core, const walked_ray& ray, voxel_result& r);
  std::vector<named_figures> figures(const jobs_type& jobs, const scheduler_stats& dispatches,
                                     const std::vector<replaying::core_schedule<core_sums, overlaps>>& cores,
                                     const result_manager_stats& results, cycle end) const;

 private:
  svo_core_params params_;
  std::vector<svo_result_registers> buses_;
};

using svo_walker = replaying::walker<svo_way>;

}  // namespace rtusim
