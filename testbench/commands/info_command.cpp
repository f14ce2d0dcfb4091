#include "testbench/commands/info_command.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "modules/formats/svo_image.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/binvox.h"
#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/commands/options.h"
#include "testbench/pictures/rgb_picture.h"
#include "testbench/pictures/voxel_views.h"

namespace rtusim {
namespace {

constexpr unsigned mesh_picture_resolution = 256;

std::string summary_text(const svo_summary& s) {
  const auto edge = static_cast<double>(std::uint64_t{1} << s.levels);
  std::string text =
      fmt::format("{:>12} bytes\n{:>12} nodes\n{:>12} far words\n{:>12} leaves\n{:>12} voxels filled ({:.3f} % of the cube)\n", s.bytes,
                  s.nodes, s.far_words, s.leaves, s.filled_voxels, 100 * s.filled_share);
  for (std::size_t k = 0; k < 3 && s.leaves != 0; ++k)
    text +=
        fmt::format("{} {:>10.0f} to {:.0f}, the first and the last voxel filled\n", "xyz"[k], s.lower[k] * edge, s.upper[k] * edge - 1);
  return text;
}

void draw(const std::filesystem::path& file, const voxel_grid& grid, const svo_summary& s) {
  if (!file.empty()) write_png(file, voxel_views(grid, s.lower, s.upper));
}

std::string octree_text(const std::filesystem::path& file, const std::filesystem::path& image) {
  const svo_image octree = read_svo(file, widest_limits);
  const svo_summary s = describe(octree, file.string(), widest_limits);
  if (!image.empty()) draw(image, coarse_voxels_of(octree, std::min(1U << s.levels, voxel_grid::most_resolution)), s);
  return fmt::format("octree of {} levels: {} voxels an edge\n", s.levels, std::uint64_t{1} << s.levels) + summary_text(s);
}

std::string binvox_text(const std::filesystem::path& file, const std::filesystem::path& image) {
  const voxel_cube cube = read_binvox(file);
  const voxel_grid& grid = cube.grid;
  const std::string text = fmt::format("voxels in a cube of {} an edge", cube.edge);
  const std::string place = fmt::format("{:>12} long, from {}: where the cube lies\n", cube.scale, fmt::join(cube.translate, " "));
  svo_summary s;
  if (grid.count() != 0) s = describe(build_svo(grid, file.string()), file.string(), widest_limits);
  draw(image, grid, s);
  if (s.levels == 0) return text + ", none filled\n" + place;
  return text + fmt::format("; as an octree of {} levels, {} voxels an edge:\n", s.levels, std::uint64_t{1} << s.levels) + summary_text(s) +
         place;
}

// As few digits as tell a coordinate from its neighbours, in binary32 if it is of that.
std::string shortest(double coordinate) {
  const auto narrow = static_cast<float>(coordinate);
  return double{narrow} == coordinate ? fmt::format("{}", narrow) : fmt::format("{}", coordinate);
}

std::string mesh_text(const std::filesystem::path& file, const std::filesystem::path& image) {
  const config::input_ledger read;
  const mesh m = read_mesh(file);
  config::check_apart({image}, read.names());  // a mesh may have more files than one
  const bounding_box box = bounds(m);
  if (!image.empty()) {
    const voxel_grid grid = voxelise_surface(m, mesh_picture_resolution);
    draw(image, grid, describe(build_svo(grid, file.string()), file.string(), widest_limits));
  }
  std::string text = fmt::format("mesh\n{:>12} vertices\n{:>12} triangles\n{:>12} open edges\n", m.vertices.size(), m.triangles.size(),
                                 find_open_edges(m).count);
  if (const std::uint64_t turned = find_turned_edges(m).count; turned != 0)
    text += fmt::format("{:>12} edges whose faces run the same way: some are turned\n", turned);
  if (!m.flat_triangles.empty()) text += fmt::format("{:>12} triangles without area besides\n", m.flat_triangles.size());
  for (int k = 0; k < 3; ++k) text += fmt::format("{} {:>12} to {}\n", "xyz"[k], shortest(box.lower[k]), shortest(box.upper[k]));
  return text;
}

}  // namespace

std::string info_text(const std::filesystem::path& file, const std::filesystem::path& image) {
  if (!image.empty()) {
    if (config::ending_of(image) != ".png") throw input_error(image.string(), "no picture format that we write", "NAME.png");
    config::check_writable_apart({image}, {file});
  }
  if (is_octree(file)) return octree_text(file, image);
  return is_binvox(file) ? binvox_text(file, image) : mesh_text(file, image);
}

void add_info(CLI::App& program) {
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App& app = add_command(program, "info", "describe an octree, voxels or a mesh", files, [](const auto& asked) {
    fmt::print(config::stream_beside({asked.second}), "{}", info_text(asked.first, asked.second));
  });
  app.add_option("FILE", files->first, "an octree (.svo), voxels (.binvox) or a mesh")->required()->type_name("");
  app.add_option("--image", files->second, "OUT.png: three slices through the middle, and a view")->type_name("FILE");
}

}  // namespace rtusim
