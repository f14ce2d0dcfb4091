#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace rtusim {

/// What a file holds, in words: the levels, nodes, leaves and bytes of an octree or of that which voxels become, and the bounds of what is
/// filled; a mesh's vertices, triangles, open edges and bounds.
///
/// `image`: the PNG that shows it as `voxel_views` does, a mesh by its surface at 256 voxels an edge; empty for none.
/// Errors: input_error for a file that is none of these, or a picture that can't be written.
std::string info_text(const std::filesystem::path& file, const std::filesystem::path& image = {});

/// Adds the command to the program.
void add_info(CLI::App& program);

}  // namespace rtusim
