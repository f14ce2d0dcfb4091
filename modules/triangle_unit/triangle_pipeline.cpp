#include "modules/triangle_unit/triangle_pipeline.h"

#include <utility>

#include "modules/config/error.h"

namespace rtusim {

triangle_pipeline::triangle_pipeline(const sc_core::sc_module_name& name, const params& p,
                                     const std::vector<accelerated_triangle>& triangles, std::shared_ptr<const triangle_lists> lists)
    : sc_module(name),
      intersector_(p.words, p.errata),
      triangles_(triangles),
      lists_(std::move(lists)),
      latency_cycles_(latency_cycles_of(p)),
      interval_cycles_(p.divider == numeric::divider_kind::iterative ? intersector_.divider_width() : 1),
      distance_unit_(distance_unit_of(p.errata)) {}

triangle_outcome triangle_pipeline::intersect(const quantised_ray& ray, std::uint32_t triangle) const {
  RTU_CHECK(triangle, <, triangles_.size());
  return intersector_.hit_only(ray.position, ray.direction, triangles_[triangle]);
}

}  // namespace rtusim
