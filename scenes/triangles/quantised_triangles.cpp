#include "scenes/triangles/quantised_triangles.h"

#include <algorithm>
#include <cmath>

#include "modules/config/error.h"

namespace rtusim {
namespace {

// With n = 32, m = 34 and E = 20 the widest number is twice the numerator of d or of an edge, below 2^102.
__extension__ using int128 = __int128;

int128 size(int128 a) { return a < 0 ? -a : a; }

// a / b to the nearest whole number, ties away from zero.
int128 rounded_ratio(int128 a, int128 b) {
  const int128 nearest = (2 * size(a) + size(b)) / (2 * size(b));
  return (a < 0) != (b < 0) ? -nearest : nearest;
}

std::int64_t within(int128 value, std::int64_t least, std::int64_t greatest) {
  return static_cast<std::int64_t>(std::clamp<int128>(value, least, greatest));
}

}  // namespace

grid_point scene_grid::nearest(const glm::dvec3& v) const {
  grid_point p;
  for (unsigned i = 0; i < 3; ++i) {
    const auto axis = static_cast<glm::length_t>(i);
    p[i] = std::llrint((v[axis] - origin[axis]) * units / side);
  }
  return p;
}

std::optional<accelerated_triangle> accelerate(const std::array<grid_point, 3>& corners, const quantisation& q, bool& clamped) {
  const auto edge = [&](unsigned vertex, unsigned axis) { return corners[vertex][axis] - corners[0][axis]; };
  per_axis<int128> normal;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = int128{edge(1, j)} * edge(2, k) - int128{edge(1, k)} * edge(2, j);
  }
  unsigned r = 0;
  for (unsigned i = 1; i < 3; ++i)
    if (size(normal[i]) > size(normal[r])) r = i;
  if (normal[r] == 0) return std::nullopt;

  accelerated_triangle a;
  const unsigned p_axis = (r + 1) % 3, q_axis = (r + 2) % 3;
  a.r = static_cast<std::uint8_t>(r);
  a.pp = corners[0][p_axis];
  a.pq = corners[0][q_axis];
  int128 offset = 0;
  for (unsigned i = 0; i < 3; ++i) offset += normal[i] * corners[0][i];
  a.d = static_cast<std::int64_t>(rounded_ratio(offset, normal[r]));

  const std::int64_t greatest = q.greatest_direction();
  const int128 unit = int128{1} << (q.m - 1), edge_unit = unit << q.edge_shift;
  const auto slope = [&](unsigned axis) { return within(rounded_ratio(normal[axis] * unit, normal[r]), -greatest - 1, greatest); };
  a.np = slope(p_axis);
  a.nq = slope(q_axis);
  const auto side = [&](unsigned vertex, unsigned axis) {
    const int128 exact = rounded_ratio(edge(vertex, axis) * edge_unit, normal[r]);
    clamped |= size(exact) > greatest;
    return within(exact, -greatest, greatest);
  };
  a.e1p = side(1, p_axis);
  a.e1q = side(1, q_axis);
  a.e2p = side(2, p_axis);
  a.e2q = side(2, q_axis);
  return a;
}

namespace {

unsigned greatest_unclamped_shift(const std::vector<std::array<grid_point, 3>>& corners, quantisation q) {
  q.edge_shift = quantisation::greatest_edge_shift;
  for (const auto& triangle : corners)
    for (bool clamped = true; clamped && q.edge_shift > 0; q.edge_shift -= clamped) {
      clamped = false;
      static_cast<void>(accelerate(triangle, q, clamped));
    }
  return q.edge_shift;
}

}  // namespace

quantised_triangles quantise(const mesh& m, const quantisation& q, const std::string& place) {
  if (m.triangles.empty()) throw input_error(place, "no triangles", "a mesh of triangles");
  const bounding_box box = bounds(m);
  const glm::dvec3 sides = box.upper - box.lower;
  quantised_triangles result;
  result.grid = {box.lower, std::max({sides.x, sides.y, sides.z}), static_cast<double>(q.greatest_coordinate())};
  if (result.grid.side > 0) result.box = result.grid.nearest(box.upper);
  for (unsigned i = 0; i < 3; ++i)
    if (result.box[i] == 0)
      throw input_error(place, fmt::format("a flat mesh: no extent along {} on a grid of 2^{}", "xyz"[i], q.n), "a box with a volume");

  std::vector<std::array<grid_point, 3>> corners(m.triangles.size());
  for (std::size_t number = 0; number < corners.size(); ++number)
    for (unsigned i = 0; i < 3; ++i) corners[number][i] = result.grid.nearest(m.vertices[m.triangles[number][i]]);
  quantisation widths = q;
  if (q.fit_edges) widths.edge_shift = greatest_unclamped_shift(corners, q);
  result.edge_shift = widths.edge_shift;

  for (std::size_t number = 0; number < corners.size(); ++number) {
    bool clamped = false;
    const auto accelerated = accelerate(corners[number], widths, clamped);
    if (!accelerated) {
      ++result.dropped;
      continue;
    }
    result.triangles.push_back(*accelerated);
    result.corners.push_back(corners[number]);
    result.source.push_back(static_cast<std::uint32_t>(number));
    result.clamped += clamped;
  }
  if (result.triangles.empty())
    throw input_error(place, fmt::format("no triangle has an area on a grid of 2^{}", q.n), "a mesh of triangles");
  return result;
}

}  // namespace rtusim
