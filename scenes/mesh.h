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

/// Turns a mesh so that the direction of `axis` (0 to 2 for x to z), or the opposite one if `negative`, comes to point along y.
void turn_up(mesh& m, unsigned axis, bool negative);

/// An edge of triangles from which a surface is missing.
struct open_edges {
  std::uint64_t count = 0;
  std::array<glm::dvec3, 2> first{};  ///< the ends of that of the first triangle that has one
};

/// The edges along which as many triangles run one way as the other are closed, usually one each way; this counts the rest. A mesh without
/// any bounds a volume.
open_edges find_open_edges(const mesh& m);

/// Reads PLY, OBJ, STL and glTF, each also zipped (`.ply.gz`), and Bezier patches (`.bpt`), told apart by the name's ending.
///
/// Polygons become triangles, the transforms of a glTF's nodes are applied, equal vertices become one; points and lines are
/// left out, and so are triangles without area. `patch_quads` (1 to 256): quads along each side of a Bezier patch, see `tessellate`.
/// The importer works in a child process, so that its faults end in an error; the caller has one thread alone (see `enclosed`).
/// Errors: input_error when the file can't be read, is cut short or garbled, claims more elements than it has, or is a mesh
/// without triangles, without extent (or one beyond 1e-60 to 1e60), with a vertex that is not finite or with a triangle over a
/// vertex that is not there.
mesh read_mesh(const std::filesystem::path& file, unsigned patch_quads = 10);

}  // namespace rtusim
