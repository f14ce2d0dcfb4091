#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "modules/formats/bih_memory.h"
#include "modules/formats/quantisation.h"
#include "modules/job_manager/ray_setup.h"
#include "testbench/bench/host_figures.h"
#include "testbench/kinds/driver.h"
#include "testbench/pictures/frame.h"

namespace rtusim {

/// What a mesh loses as it is put on the triangle cores' grid.
struct triangle_losses {
  std::uint64_t dropped = 0;  ///< triangles without area on the grid
  std::uint64_t clamped = 0;  ///< triangles with an edge component beyond what m bits hold
};

/// What becomes of a mesh on its way to triangle cores.
class triangle_figures final : public model_figures {
 public:
  triangle_losses losses;
  unsigned edge_shift = 0;  ///< `quantisation.edge_shift`, chosen or given

  void describe(config::report& r) const override;
  void warn(std::vector<std::string>& all) const override;
};

/// A mesh as triangle cores trace it, and where it stands in the world: its box' middle in the origin, half of its longest side 0.98, as
/// voxels of the same mesh stand.
struct triangle_model {
  bih_memory hierarchy;
  grid_mapping grid;
  std::vector<std::array<float, 3>> normals;  ///< of each triangle of the hierarchy, of length 1, by the right hand
  std::vector<std::uint32_t> faces;           ///< of each: the mesh's face that it is a part of, see `mesh::face_of`
  triangle_losses losses;
  unsigned edge_shift = 0;  ///< with which its edges are quantised
};

/// Reads a mesh, puts it on the grid and builds its hierarchy. `patch_quads`: see `read_mesh`.
/// Errors: input_error for a file that can't be used, an octree, a mesh without thickness along an axis, a hierarchy that does not fit.
triangle_model load_triangles(const std::filesystem::path& file, const quantisation& q, unsigned leaf_triangles, unsigned address_bits,
                              unsigned patch_quads);

/// What a result of triangle cores shows in the world.
class triangle_surfaces {
 public:
  /// `distance_unit`: grid units that the last bit of a result's t is worth. Both must outlive this.
  triangle_surfaces(const triangle_model& model, const quantisation& q, std::int64_t distance_unit);

  /// The distance of a hit from its ray's origin, in world units, the normal, turned to where the ray came from, and the mesh's face.
  frame::surface at(const job_packet& job, const mesh_result& r) const;

 private:
  const triangle_model& model_;
  ray_setup setup_;
  double one_;  // of a direction
  double origin_unit_;
  double distance_unit_;
};

}  // namespace rtusim
