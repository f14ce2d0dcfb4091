#include "modules/bih_core/bih_params.h"

namespace rtusim {

void bih_core_params::describe(config::section& s) {
  s.number("address_bits", address_bits, {least_bih_address_bits, most_bih_address_bits}, "bits",
           "addresses of the node memories; the last 32 hold the stack");
  s.number("rays_in_flight", rays_in_flight, {1, 64}, "rays", "rays whose triangles may be in the intersector at a time");
  s.flag("early_out", early_out, "nodes that begin behind a hit that is known by then are not visited");
  s.erratum("exit_at_zero", exit_at_zero, "a ray that points down an axis from 0 leaves the box at -2^n", "it leaves at once");
  s.erratum("box_never_misses", box_never_misses, "distances to the box wrap at n bits, so that each ray meets it",
            "a ray that misses it takes one cycle");
  s.erratum("stack_wraps", stack_wraps, "the 32nd nested push empties the stack", "it is an error that names the ray");
  s.erratum("empty_leaf_hangs", empty_leaf_hangs, "a leaf of 0 triangles takes 2^32 cycles", "it takes one, without a triangle");
}

bih_visits& bih_visits::operator-=(const bih_visits& v) {
  aabb -= v.aabb;
  node -= v.node;
  inner -= v.inner;
  push -= v.push;
  pop -= v.pop;
  leaf -= v.leaf;
  return *this;
}

bih_visits& bih_visits::operator+=(const bih_visits& v) {
  aabb += v.aabb;
  node += v.node;
  inner += v.inner;
  push += v.push;
  pop += v.pop;
  leaf += v.leaf;
  return *this;
}

bih_interval box_interval(const quantised_ray& ray, const per_axis<std::int64_t>& corner, const bih_core_params& p) {
  return box_interval(ray, corner, p, [&](std::int64_t difference, unsigned axis) {
    return numeric::plane_distance(difference, ray.reciprocal[axis], p.widths.reciprocal_bits);
  });
}

simulation_error bih_stack_overflow(const std::string& core, std::uint64_t ray) {
  return simulation_error(fmt::format("{}: ray {} pushes an entry on a stack that holds {}: the hierarchy needs fewer levels", core, ray,
                                      most_bih_stack_entries));
}

}  // namespace rtusim
