#include "scenes/scene.h"

#include "scenes/meshes/mesh.h"
#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/voxel_grid.h"

namespace rtusim {
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
  s.add("scene", model, home);
  s.add("frame", picture, home);
  s.add("camera", view, home);
  s.read_when(
      {"camera"}, [this] { return model.rays.empty(); }, "scene.rays names no file");
}

bool is_model(const std::filesystem::path& file) { return holds_voxels(file) || is_mesh(file); }

}  // namespace rtusim
