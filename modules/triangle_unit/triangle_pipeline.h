#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <systemc>

#include "modules/triangle_unit/triangle_lists.h"
#include "modules/triangle_unit/triangle_unit.h"

namespace rtusim {

/// What a core sees of the triangle memory and the intersector behind it. It puts a triangle's number to the memory in a cycle of its
/// own choice, `interval_cycles` or more after the last one, and has the outcome `latency_cycles` later.
class intersector_interface : public virtual sc_core::sc_interface {
 public:
  /// Of what is no hit u, v and t are not told.
  virtual triangle_outcome intersect(const quantised_ray& ray, std::uint32_t triangle) const = 0;
  virtual unsigned latency_cycles() const = 0;
  virtual unsigned interval_cycles() const = 0;
  /// Grid units that the last bit of an outcome's t is worth.
  virtual std::int64_t distance_unit() const = 0;
  /// Its triangles as the leaves list them, to test many at a time; null where that is not covered.
  virtual const triangle_lists* lists() const = 0;
};

/// The triangle memory and the intersector as a core has them for itself (Hanika 2007, sec. 3.1): nothing can make it stall, so what
/// leaves it follows from what enters.
///
/// Timing: 1 cycle in the memory's address register, then the stages of `triangle_unit`: 42 as built.
class triangle_pipeline final : public sc_core::sc_module, public intersector_interface {
 public:
  using params = triangle_unit_params;

  /// `triangles` must outlive the module; `lists`, if not null, are of them. Errors: those of `triangle_intersector`.
  triangle_pipeline(const sc_core::sc_module_name& name, const params& p, const std::vector<accelerated_triangle>& triangles,
                    std::shared_ptr<const triangle_lists> lists = nullptr);

  /// What these parameters come to.
  static unsigned latency_cycles_of(const params& p) { return 1 + triangle_unit::stages_of(p); }
  static std::int64_t distance_unit_of(const triangle_errata& errata) { return errata.t_halved ? 2 : 1; }

  triangle_outcome intersect(const quantised_ray& ray, std::uint32_t triangle) const override;
  unsigned latency_cycles() const override { return latency_cycles_; }
  unsigned interval_cycles() const override { return interval_cycles_; }
  std::int64_t distance_unit() const override { return distance_unit_; }
  const triangle_lists* lists() const override { return lists_.get(); }

 private:
  triangle_intersector intersector_;
  const std::vector<accelerated_triangle>& triangles_;
  std::shared_ptr<const triangle_lists> lists_;
  unsigned latency_cycles_;
  unsigned interval_cycles_;
  std::int64_t distance_unit_;
};

}  // namespace rtusim
