#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace rtusim {

/// A polygon that is not convex may have so many corners; the work grows with their square or more.
inline constexpr std::size_t most_concave_corners = 1000;

/// Cuts a simple polygon into triangles by clipping ears (Meisters 1975), or from its first corner if it is convex. It may be
/// concave, and bent a little; then its projection along the longest axis of its normal decides.
///
/// `corners`: indices into `vertices`, in order around it. The triangles keep its sense of rotation; those without area in the
/// projection are left out. A polygon that crosses itself gives some triangles over its corners.
/// At most `most_concave_corners` if it is not convex; `is_convex` tells.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners);

/// Whether every corner turns the same way, or not at all, in one turn around.
bool is_convex(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners);

}  // namespace rtusim
