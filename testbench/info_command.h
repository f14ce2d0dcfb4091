#pragma once

#include <filesystem>
#include <string>

namespace rtusim {

/// What a file holds, in words: an octree's levels, nodes, leaves and bytes; a mesh's vertices, triangles and bounds.
/// Errors: input_error for a file that is neither.
std::string info_text(const std::filesystem::path& file);

}  // namespace rtusim
