#pragma once

#include <filesystem>

#include "modules/formats/svo_image.h"

namespace rtusim {

/// What holds more than the usual design does: files are described and converted beyond it. 256 MB, as deep as can be counted.
inline constexpr svo_limits widest_limits{26, 20};

/// The octree of a model: an `.svo` as it is; a `.binvox` as its voxels; a mesh (see `read_mesh`) as its surface voxels, `resolution`
/// an edge.
/// Errors: input_error for a file that can't be used, a resolution that is no power of two, an octree beyond `limits`.
svo_image load_octree(const std::filesystem::path& file, unsigned resolution, unsigned patch_quads, const svo_limits& limits);

/// Whether the file's name is that of an octree (.svo) or of voxels (.binvox), zipped or not.
bool is_octree(const std::filesystem::path& file);
bool is_binvox(const std::filesystem::path& file);

/// Whether it is either, so that no resolution is asked for.
bool holds_voxels(const std::filesystem::path& file);

}  // namespace rtusim
