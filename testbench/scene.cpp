#include "testbench/scene.h"

#include <algorithm>
#include <iterator>

#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "scenes/binvox.h"
#include "scenes/mesh.h"
#include "scenes/svo_builder.h"
#include "scenes/voxeliser.h"

namespace rtusim {
namespace {

bool ends_in(const std::filesystem::path& file, const char* ending) { return config::unzipped_ending_of(file) == ending; }

}  // namespace

void scene::model_params::describe(config::section& s) {
  s.text("model", model,
         "an octree (.svo), voxels (.binvox) or a mesh (.ply, .obj, .stl, .gltf, .bpt), zipped or not; a path in a scene file starts at "
         "its folder");
  s.text("rays", rays,
         "a list of rays (.csv, .bin; zipped or not) in place of the camera, ray i of pixel i; a path in a scene file starts at its folder")
      .when([this] { return !rays.empty(); }, "scene.rays names a file");
  s.number("resolution", resolution, {voxel_grid::least_resolution, voxel_grid::most_resolution}, "voxels",
           "voxels an edge, a power of two, that a mesh is divided into")
      .when([this] { return !holds_voxels(model); }, "scene.model is a mesh");
  s.number("patch_quads", patch_quads, {1, 256}, "quads", "quads along each side of a Bezier patch")
      .when([this] { return has_patches(model); }, "scene.model is a .bpt");
}

void scene::describe(config::schema& s) {
  constexpr auto home = "a scene file";
  s.add("scene", model, home);
  s.add("frame", picture, home);
  s.add("camera", view, home);
  s.read_when({"camera"}, [this] { return model.rays.empty(); }, "scene.rays names no file");
}

const std::set<std::string>& scene::sections() {
  static const std::set<std::string> names{"scene", "frame", "camera"};
  return names;
}

bool is_octree(const std::filesystem::path& file) { return ends_in(file, ".svo"); }

bool is_binvox(const std::filesystem::path& file) { return ends_in(file, ".binvox"); }

bool holds_voxels(const std::filesystem::path& file) { return is_octree(file) || is_binvox(file); }

bool is_model(const std::filesystem::path& file) {
  constexpr const char* meshes[] = {".ply", ".obj", ".stl", ".gltf", ".glb"};
  return holds_voxels(file) || has_patches(file) ||
         std::any_of(std::begin(meshes), std::end(meshes), [&](const char* e) { return ends_in(file, e); });
}

bool has_patches(const std::filesystem::path& file) { return ends_in(file, ".bpt"); }

svo_image load_model(const std::filesystem::path& file, unsigned resolution, unsigned patch_quads, const svo_limits& limits) {
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
