#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "modules/config/error.h"
#include "modules/config/section.h"
#include "modules/formats/bih_word.h"
#include "modules/formats/quantisation.h"
#include "modules/numeric/plane_distance.h"

namespace rtusim {

/// States of the hierarchy's core (Hanika 2007, sec. 3.4, table 3.1).
enum class bih_state : std::uint8_t { aabb, node, inner, push, pop, leaf };
inline constexpr std::string_view bih_state_words[] = {"aabb", "node", "inner", "push", "pop", "leaf"};

/// Cycles from a triangle number to its result as built: 1 in the triangle memory, 41 in the intersector.
inline constexpr unsigned bih_result_latency_cycles = 42;

/// In place of a hit's distance: none.
inline constexpr std::int64_t no_hit = std::numeric_limits<std::int64_t>::max();

struct bih_core_params {
  unsigned address_bits = 16;
  bool exit_at_zero = false;
  bool box_never_misses = false;
  bool stack_wraps = false;
  bool empty_leaf_hangs = false;
  bool early_out = false;
  unsigned rays_in_flight = 16;
  unsigned result_latency_cycles = bih_result_latency_cycles;  ///< for early_out: from a triangle number to its result
  unsigned triangle_interval_cycles = 1;  ///< cycles from one triangle to the next at least: the bits of an iterative divider, else 1
  quantisation widths;                    ///< of the section `quantisation`

  void describe(config::section& s);
};

/// Cycles by state.
struct bih_visits {
  std::uint64_t aabb = 0, node = 0, inner = 0, push = 0, pop = 0, leaf = 0;

  std::uint64_t cycles() const { return aabb + node + inner + push + pop + leaf; }
  bih_visits& operator+=(const bih_visits& v);
  bih_visits& operator-=(const bih_visits& v);
};

/// What a ray's traversal comes to.
struct bih_outcome {
  bih_visits visits;
  std::uint64_t triangles = 0;  ///< numbers issued
  std::uint32_t max_stack = 0;  ///< largest stack_pos
  bool overflow = false;        ///< the stack has no room for an entry: no outcome

  std::uint64_t cycles() const { return visits.cycles(); }
};

/// Registers that a core keeps from ray to ray.
struct bih_kept_registers {
  std::int64_t tmin = 0, tmax = 0, dist0 = 0, dist1 = 0;
  std::uint32_t address3x = 0, address1x = 0;  ///< registers of the memories
  std::uint64_t divider_clocks = 0;            ///< for which the divider is not yet free
};

/// All that a core keeps from ray to ray.
struct bih_kept : bih_kept_registers {
  std::array<bih_words, bih_stack_words> stack{};  ///< the core's own words at the stack's addresses
};

/// The part of a ray inside the scene's box, whose lower corner is 0.
struct bih_interval {
  std::int64_t tmin = 0, tmax = 0;
  bool missed = false;
};
/// `distance(difference, axis)`: as numeric::plane_distance with the ray's reciprocal on that axis.
template <class Distance>
bih_interval box_interval(const quantised_ray& ray, const per_axis<std::int64_t>& corner, const bih_core_params& p,
                          const Distance& distance) {
  const std::int64_t grid = std::int64_t{1} << p.widths.n;
  bih_interval inside{0, numeric::greatest_distance, false};
  for (unsigned i = 0; i < 3; ++i) {
    const std::int64_t position = ray.position[i] & (grid - 1);
    const std::int64_t up = corner[i] - position;
    if (ray.reciprocal[i] >= 0) {
      inside.tmax = std::min(inside.tmax, distance(p.box_never_misses ? up & (grid - 1) : up, i));
    } else {
      inside.tmax = std::min(inside.tmax, distance(p.exit_at_zero && position == 0 ? -grid : -position, i));
      // The entry of a ray that starts inside of the slab is not ahead.
      if (up < 0 && !p.box_never_misses) inside.tmin = std::max(inside.tmin, distance(up, i));
    }
  }
  inside.missed = !p.box_never_misses && (ray.misses_box || inside.tmin > inside.tmax);
  return inside;
}
bih_interval box_interval(const quantised_ray& ray, const per_axis<std::int64_t>& corner, const bih_core_params& p);

/// The fault of a ray that pushes one entry more than the stack holds; `core`: the instance's name, `ray`: which of its rays.
simulation_error bih_stack_overflow(const std::string& core, std::uint64_t ray);

}  // namespace rtusim
