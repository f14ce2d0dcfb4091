#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "modules/config/schema.h"
#include "modules/formats/svo_image.h"
#include "testbench/camera.h"
#include "testbench/frame.h"

namespace rtusim {

/// What is traced and from where: a scene file.
struct scene {
  struct model_params {
    std::string model;
    std::string rays;
    unsigned resolution = 32;
    unsigned patch_quads = 10;
    void describe(config::section& s);
  };

  model_params model;
  frame::params picture;
  camera::params view;

  void describe(config::schema& s);
  static const std::set<std::string>& sections();
};

/// What holds more than the usual design does: files are described and converted beyond it. 256 MB, as deep as can be counted.
inline constexpr svo_limits widest_limits{26, 20};

/// The octree of a model: an `.svo` as it is; a `.binvox` as its voxels; a mesh (see `read_mesh`) as its surface voxels, `resolution`
/// an edge.
/// Errors: input_error for a file that can't be used, a resolution that is no power of two, an octree beyond `limits`.
svo_image load_model(const std::filesystem::path& file, unsigned resolution, unsigned patch_quads, const svo_limits& limits);

/// Whether the file holds Bezier patches, so that it is asked into how many quads each is cut.
bool has_patches(const std::filesystem::path& file);

/// Whether the file's name is that of an octree (.svo) or of voxels (.binvox), zipped or not.
bool is_octree(const std::filesystem::path& file);
bool is_binvox(const std::filesystem::path& file);

/// Whether it is either, so that no resolution is asked for.
bool holds_voxels(const std::filesystem::path& file);

/// Whether the file's name is that of a model of any kind.
bool is_model(const std::filesystem::path& file);

}  // namespace rtusim
