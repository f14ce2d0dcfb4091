#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "modules/bih_core/bih_walk.h"
#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"
#include "modules/triangle_unit/triangle_lists.h"
#include "modules/triangle_unit/triangle_unit.h"

namespace rtusim {

/// What a ray comes to in a triangle core, whenever it gets there.
struct bih_ray {
  bih_outcome outcome;
  triangle_unit::stats triangles;  ///< the pairs that it issued
  mesh_result result;              ///< its nearest hit, the first of those that are equally near; not which job it was, nor where
};

/// Tests a hierarchy's triangles many at a time, in the order of its lists; null where these words are not covered.
inline std::shared_ptr<const triangle_lists> lists_of(const bih_tables& tables, const bih_memory& memory, const quantisation& widths,
                                                      const triangle_errata& errata) {
  if (!triangle_lists::covers(widths, errata)) return nullptr;
  return std::make_shared<triangle_lists>(widths, tables.lists, memory.triangles);
}

/// Keeps the nearest of the hits on a ray's way. `Intersect`: `(triangle)` to its triangle_outcome.
template <class Intersect>
class nearest_hit {
 public:
  static constexpr bool takes_leaves = true;

  /// `distance_unit`: grid units that the last bit of an outcome's t is worth. `lists`: if not null, tests many at a time.
  nearest_hit(bih_ray& to, const quantised_ray& ray, std::int64_t distance_unit, const triangle_lists* lists, Intersect& intersect)
      : to_(to), ray_(ray), distance_unit_(distance_unit), lists_(lists), intersect_(intersect) {}

  std::int64_t operator()(std::uint32_t triangle, std::uint64_t) {
    ++to_.triangles.pairs;
    return tested(triangle);
  }
  template <class Hit>
  void leaf(std::uint32_t first, const std::uint32_t* numbers, std::uint32_t count, Hit&& hit) {
    to_.triangles.pairs += count;
    const auto test = [&](std::uint32_t i) {
      if (const std::int64_t distance = tested(numbers[i]); distance != no_hit) hit(i, distance);
    };
    if (lists_ == nullptr) {
      for (std::uint32_t i = 0; i < count; ++i) test(i);
      return;
    }
    for (std::uint32_t i = 0; i < count; i += triangle_lists::most) {
      const auto v = (*lists_)(ray_.position, ray_.direction, first + i, std::min(count - i, triangle_lists::most));
      to_.triangles.errors += v.errors;
      to_.triangles.wrapped += v.wrapped;
      for (std::uint64_t open = v.open; open != 0; open &= open - 1) test(i + static_cast<std::uint32_t>(__builtin_ctzll(open)));
    }
  }

 private:
  std::int64_t tested(std::uint32_t triangle) {
    const triangle_outcome o = intersect_(triangle);
    to_.triangles.hits += o.hit;
    to_.triangles.errors += o.err;
    to_.triangles.wrapped += o.wrapped;
    if (!o.hit) return no_hit;
    mesh_result& r = to_.result;
    const auto t = static_cast<std::int64_t>(o.t);
    if (!r.hit || t < r.t_hit) {
      r.hit = true;
      r.triangle = triangle;
      r.t_hit = t;
      r.u = static_cast<std::int64_t>(o.u);
      r.v = static_cast<std::int64_t>(o.v);
    }
    return t * distance_unit_;
  }

  bih_ray& to_;
  const quantised_ray& ray_;
  std::int64_t distance_unit_;
  const triangle_lists* lists_;
  Intersect& intersect_;
};

/// Follows a ray to its end.
template <class Intersect>
bih_ray follow(bih_walk& walk, const quantised_ray& ray, std::int64_t distance_unit, const triangle_lists* lists, Intersect&& intersect) {
  bih_ray all;
  all.outcome = walk(ray, nearest_hit(all, ray, distance_unit, lists, intersect));
  all.result.cost = static_cast<std::uint32_t>(all.outcome.cycles());
  return all;
}

}  // namespace rtusim
