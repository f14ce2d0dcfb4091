#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace rtusim {

/// What `rtusim convert` was asked for.
struct convert_options {
  std::filesystem::path from;
  std::filesystem::path to;
  std::optional<unsigned> resolution;
  bool solid = false;
  std::optional<std::string> up;   ///< x, y, z, -x, -y or -z: what points up in the mesh
  std::optional<unsigned> margin;  ///< voxels between the cube's faces and what the mesh may take
  std::optional<double> fit;       ///< share of that which its longest edge takes, above 0 to 1
  bool quiet = false;
};

/// Makes an octree (.svo) or voxels (.binvox) of a mesh, or one of these of the other, and tells what came of it, in words.
///
/// A mesh becomes `resolution` voxels an edge, those of its surface or, if `solid`, also those inside; faces that are turned against
/// their neighbours are turned back for that (`turn_alike`). Voxels keep their number unless `resolution` asks for more: an octree is
/// divided further, a `.binvox` comes to stand in the middle.
///
/// An octree has a power of two of voxels an edge and lies in [-1,1]^3. A `.binvox` of another edge comes to stand in the middle of it,
/// and `resolution` N takes N in the middle of the least power of two back out. Its place in space is lost, which is told.
/// Errors: input_error for files and options that can't be used, for a mesh that is not closed though `solid`, for filled voxels
/// outside the middle.
std::string convert(const convert_options& options);

/// Adds the command to the program.
void add_convert(CLI::App& program);

}  // namespace rtusim
