#include "scenes/voxels/octree_model.h"

#include <fmt/format.h>

#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/binvox.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"

namespace rtusim {

bool is_octree(const std::filesystem::path& file) { return config::unzipped_ending_of(file) == ".svo"; }

bool is_binvox(const std::filesystem::path& file) { return config::unzipped_ending_of(file) == ".binvox"; }

bool holds_voxels(const std::filesystem::path& file) { return is_octree(file) || is_binvox(file); }

svo_image load_octree(const std::filesystem::path& file, unsigned resolution, unsigned patch_quads, const svo_limits& limits) {
  if (is_octree(file)) return read_svo(file, limits);
  if (is_binvox(file)) {
    svo_image image = build_svo(read_binvox(file).grid, file.string());
    check_svo(image, file.string(), limits);
    return image;
  }
  if (!voxel_grid::is_resolution(resolution))
    throw input_error("scene.resolution", std::to_string(resolution), fmt::format("a power of two up to {}", voxel_grid::most_resolution));
  svo_image image = build_svo(voxelise_surface(read_mesh(file, patch_quads), resolution), file.string());
  check_svo(image, fmt::format("{} at {} voxels an edge", file.string(), resolution), limits);
  return image;
}

}  // namespace rtusim
