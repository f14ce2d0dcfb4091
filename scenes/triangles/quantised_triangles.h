#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "modules/formats/quantisation.h"
#include "scenes/meshes/mesh.h"

namespace rtusim {

/// A corner on the grid.
using grid_point = per_axis<std::int64_t>;

/// The grid that a scene is put on: its lower corner becomes 0, its longest side 2^n - 1, one scale for all axes (Hanika 2007, sec. 2.1.2).
struct scene_grid {
  glm::dvec3 origin{0.0};  ///< what becomes 0
  double side = 1.0;       ///< the longest side, in the mesh's unit of length
  double units = 1.0;      ///< and in grid units

  /// The nearest point, half to even, of (v - origin) units / side in binary64.
  grid_point nearest(const glm::dvec3& v) const;
};

/// A mesh as the triangle tracer has it in its memories.
struct quantised_triangles {
  scene_grid grid;
  grid_point box{};                                ///< the scene's upper corner; the lower one is 0
  std::vector<accelerated_triangle> triangles;     ///< in the mesh's order, without those that are dropped
  std::vector<std::array<grid_point, 3>> corners;  ///< of each
  std::vector<std::uint32_t> source;               ///< of each: which triangle of the mesh it is
  std::uint64_t dropped = 0;                       ///< triangles without area on the grid
  std::uint64_t clamped = 0;                       ///< triangles with an edge component beyond what m bits hold
  unsigned edge_shift = 0;                         ///< that of the quantisation, or what was chosen in its place
};

/// A triangle over corners from 0 to 2^n - 1, computed exactly and rounded once, to nearest, ties away from zero (Hanika 2007, sec. 2.1);
/// nothing when it has no area. `clamped` is set when an edge component was clamped to +-(2^(m-1) - 1).
std::optional<accelerated_triangle> accelerate(const std::array<grid_point, 3>& corners, const quantisation& q, bool& clamped);

/// Puts a mesh on the grid. `place` names it in errors. With `fit_edges` the edge shift is the greatest with which no edge is clamped, or
/// 0.
/// Errors: input_error for a mesh without triangles, one whose box has no thickness on the grid along an axis, and one whose
/// triangles all lose their area.
quantised_triangles quantise(const mesh& m, const quantisation& q, const std::string& place);

}  // namespace rtusim
