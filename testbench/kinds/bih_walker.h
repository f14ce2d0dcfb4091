#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "modules/bih_core/bih_core.h"
#include "modules/bih_core/bih_kind.h"
#include "modules/bih_core/bih_ray.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/job_manager/triangle_job_manager.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "testbench/replay/schedule.h"

namespace rtusim {

/// What a replay has to know of triangle cores: see `replaying::schedule` and `replaying::walker`. A ray's cycles and result are its own as
/// long as it waits for no division of the one before (`bih_kind::replay_obstacle`).
class bih_way {
 public:
  struct walked_ray {
    std::int64_t t_hit, u, v;
    std::uint32_t job_word;
    std::uint32_t cost;
    std::uint32_t triangle;
    // For the figures of the core that takes it.
    std::uint32_t inner, push, pop, leaf;
    std::uint32_t pairs, hits, errors, wrapped;
    std::uint8_t max_stack;
    bool hit;
    bool overflow;
  };
  using jobs_type = triangle_job_manager::stats;
  using result_type = mesh_result;
  struct core_sums : bih_core::stats {
    void add(const walked_ray& ray);
  };
  static constexpr bool overlaps = true;

  /// Sets rays up and follows them through a hierarchy, which must outlive this.
  class walk {
   public:
    walk(const bih_kind& kind, const bih_memory& hierarchy)
        : walk(kind, hierarchy, std::make_shared<const bih_tables>(kind.words, hierarchy)) {}

    void operator()(const job_packet* jobs, std::size_t count, walked_ray* to, jobs_type& counted) {
      for (std::size_t i = 0; i < count; ++i) to[i] = one(jobs[i], counted);
    }

   private:
    walk(const bih_kind& kind, const bih_memory& hierarchy, const std::shared_ptr<const bih_tables>& tables);
    walked_ray one(const job_packet& packet, jobs_type& counted);

    ray_setup set_up_;
    bih_walk walk_;
    triangle_intersector intersector_;
    const std::vector<accelerated_triangle>& triangles_;
    std::shared_ptr<const triangle_lists> lists_;
    std::int64_t distance_unit_;
  };

  explicit bih_way(const design& d);

  unsigned job_latency_cycles() const { return job_latency_cycles_; }
  unsigned rays_in_flight() const { return rays_in_flight_; }
  unsigned result_latency_cycles() const { return result_latency_cycles_; }
  void check(const walked_ray& ray, unsigned core, std::uint32_t job, cycle dispatched) const;
  void show(unsigned core, const walked_ray& ray, mesh_result& r) const;
  std::vector<named_figures> figures(const jobs_type& jobs, const scheduler_stats& dispatches,
                                     const std::vector<replaying::core_schedule<core_sums, overlaps>>& cores,
                                     const result_manager_stats& results, cycle end) const;

 private:
  unsigned job_latency_cycles_;
  unsigned rays_in_flight_;
  unsigned result_latency_cycles_;
};

using bih_walker = replaying::walker<bih_way>;

}  // namespace rtusim
