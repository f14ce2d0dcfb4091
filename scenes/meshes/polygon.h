#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace rtusim {

/// What a file's reader gives: vertices, and faces over them. Every corner is the index of a vertex that is there.
struct polygons {
  std::vector<glm::dvec3> vertices;
  std::vector<std::uint32_t> corners;  ///< of all faces, one face after the other, each in its order around
  std::vector<std::uint32_t> sizes;    ///< how many corners each face has

  /// Adds a face.
  template <class Corners>
  void add(const Corners& face) {
    corners.insert(corners.end(), face.begin(), face.end());
    sizes.push_back(static_cast<std::uint32_t>(face.size()));
  }
};

/// A polygon that is not convex may have so many corners; the work grows with their square.
inline constexpr std::size_t most_concave_corners = 1000;

/// Cuts a simple polygon into triangles by clipping ears (Meisters 1975), or from its first corner if it is strictly convex. It may be
/// concave, and bent a little; then its projection along the longest axis of its normal decides.
///
/// `corners`: indices into `vertices`, in order around it. There are two triangles less than corners, whatever these are; they keep
/// the polygon's sense of rotation, and each side of it is a side of one triangle, every other side being shared by two that run
/// opposite ways. Straight corners give no triangle without area if the polygon is simple. One that crosses itself gives some triangles
/// over its corners.
/// At most `most_concave_corners` if it is not convex; `is_convex` tells.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners);

/// Whether every corner turns the same way, or not at all, in one turn around.
bool is_convex(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners);

}  // namespace rtusim
