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
  std::vector<std::uint32_t> faces;                     ///< of each triangle: see `face_of`; empty where every triangle is a face
  /// Those without area: nothing hits them, so they are not traced. Their edges count for whether the mesh closes, and whoever moves
  /// vertices, onto a grid for instance, and then counts how often a line crosses the surface or the surface winds around a point needs
  /// them along with the others: on the grid they may have an area, without which the surface has a slit.
  std::vector<std::array<std::uint32_t, 3>> flat_triangles;

  /// All triangles by number, those without area after the others.
  std::size_t all_triangles() const { return triangles.size() + flat_triangles.size(); }
  const std::array<std::uint32_t, 3>& triangle(std::size_t n) const {
    return n < triangles.size() ? triangles[n] : flat_triangles[n - triangles.size()];
  }
  std::array<std::uint32_t, 3>& triangle(std::size_t n) {
    return n < triangles.size() ? triangles[n] : flat_triangles[n - triangles.size()];
  }

  /// Which of the file's faces a triangle is or was cut out of, counted from 0 over all faces, also those without area.
  std::uint32_t face_of(std::size_t triangle) const { return faces.empty() ? static_cast<std::uint32_t>(triangle) : faces[triangle]; }
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

/// Edges of a mesh, its triangles without area included.
struct edge_faults {
  std::uint64_t count = 0;
  std::array<glm::dvec3, 2> first{};  ///< the ends of that of the first triangle that has one
};

/// Edges from which a surface is missing: an odd number of triangles meets there. A mesh without any bounds a volume.
edge_faults find_open_edges(const mesh& m);

/// Edges at which an even number of triangles meets, but not as many that run one way as the other: some face there, usually one of two, is
/// turned. Without these and without open edges a surface winds around every point a whole number of times.
edge_faults find_turned_edges(const mesh& m);

/// Reads PLY, OBJ, STL and glTF, each also zipped (`.ply.gz`), and Bezier patches (`.bpt`), told apart by the name's ending; see
/// `parse_ply`, `parse_obj`, `parse_stl`, `parse_gltf` and `parse_bpt`.
///
/// Polygons become triangles (see `triangulate`). Vertices keep their binary64 coordinates; those that agree in binary32 become one, the
/// first, unless that would take an edge from a face; a mesh that lies further from the origin than 256 times its extent is moved there for
/// the comparison. Points and lines are left out. `patch_quads` (1 to 256): quads along each side of a Bezier patch, see `tessellate`,
/// whose triangles count as faces. Files beside a glTF are read if they lie, links followed, in its folder or below.
/// Errors: input_error when the file can't be read, is cut short or garbled, claims more elements than it has, or is a mesh
/// without triangles, without extent (or one beyond 1e-60 to 1e60), with a vertex that is not finite or with a triangle over a
/// vertex that is not there.
mesh read_mesh(const std::filesystem::path& file, unsigned patch_quads = 10);

/// Whether the file's name is that of a mesh, zipped or not.
bool is_mesh(const std::filesystem::path& file);

/// Whether it is that of Bezier patches, so that it is asked into how many quads each is cut.
bool has_patches(const std::filesystem::path& file);

}  // namespace rtusim
