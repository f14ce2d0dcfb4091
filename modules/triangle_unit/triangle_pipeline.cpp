#include "modules/triangle_unit/triangle_pipeline.h"

#include "modules/config/error.h"

namespace rtusim {

triangle_pipeline::triangle_pipeline(const sc_core::sc_module_name& name, const params& p,
                                     const std::vector<accelerated_triangle>& triangles)
    : sc_module(name),
      intersector_(p.words, p.errata),
      triangles_(triangles),
      latency_cycles_(1 + triangle_unit::stages_of(p)),
      interval_cycles_(p.divider == numeric::divider_kind::iterative ? intersector_.divider_width() : 1),
      distance_unit_(p.errata.t_halved ? 2 : 1) {}

triangle_outcome triangle_pipeline::intersect(const quantised_ray& ray, std::uint32_t triangle) const {
  RTU_CHECK(triangle, <, triangles_.size());
  return intersector_.hit_only(ray.position, ray.direction, triangles_[triangle]);
}

}  // namespace rtusim
