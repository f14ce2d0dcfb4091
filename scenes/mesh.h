#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

namespace rtusim {

/// Triangles over shared vertices. The unit of length is the file's.
struct mesh {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// The smallest box with faces along the axes around a mesh.
struct bounding_box {
  glm::dvec3 lower{0.0};
  glm::dvec3 upper{0.0};

  glm::dvec3 centre() const { return (lower + upper) * 0.5; }
  /// Half of the longest edge.
  double half_extent() const;
};

/// Of the vertices that the triangles use; all zero without triangles.
bounding_box bounds(const mesh& m);

/// Reads PLY, OBJ, STL and glTF, each also zipped (`.ply.gz`), and Bezier patches (`.bpt`), told apart by the name's ending.
///
/// Polygons become triangles, the transforms of a glTF's nodes are applied, equal vertices become one; points and lines are
/// left out, and so are triangles without area. `patch_quads` (1 to 256): quads along each side of a Bezier patch, see `tessellate`.
/// Errors: input_error when the file can't be read, is cut short or garbled, claims more elements than it has, or is a mesh
/// without triangles, without extent (or one beyond 1e-60 to 1e60), with a vertex that is not finite or with a triangle over a
/// vertex that is not there.
mesh read_mesh(const std::filesystem::path& file, unsigned patch_quads = 10);

}  // namespace rtusim
