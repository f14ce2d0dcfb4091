#include "testbench/convert_command.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/formats/svo_image.h"
#include "scenes/binvox.h"
#include "scenes/mesh.h"
#include "scenes/svo_builder.h"
#include "scenes/voxeliser.h"
#include "testbench/progress_line.h"
#include "testbench/scene.h"

namespace rtusim {
namespace {

std::string resolutions() { return fmt::format("a power of two from {} to {}", voxel_grid::least_resolution, voxel_grid::most_resolution); }

void check_options(const convert_options& o) {
  if (o.to.extension() != ".svo" && o.to.extension() != ".binvox")
    throw input_error(o.to.string(), fmt::format("an output ending in \"{}\"", o.to.extension().string()), ".svo or .binvox");
  if (o.resolution && !voxel_grid::is_resolution(*o.resolution))
    throw input_error("--resolution", std::to_string(*o.resolution), resolutions());
  if (holds_voxels(o.from)) {
    const std::pair<const char*, bool> of_meshes[] = {
        {"--solid", o.solid}, {"--up", o.up.has_value()}, {"--margin", o.margin.has_value()}, {"--fit", o.fit.has_value()}};
    for (const auto& [name, given] : of_meshes)
      if (given) throw input_error(name, fmt::format("given with {}, which holds voxels", o.from.string()), "a mesh with it");
  } else if (!o.resolution) {
    throw input_error("convert", "no --resolution", resolutions());
  }
  if (o.margin && 2 * std::uint64_t{*o.margin} >= *o.resolution)
    throw input_error("--margin", std::to_string(*o.margin), fmt::format("less than half of the {} voxels an edge", *o.resolution));
  if (o.fit && !(*o.fit > 0 && *o.fit <= 1)) throw input_error("--fit", fmt::format("{}", *o.fit), "above 0, at most 1");
}

void stand_up(mesh& m, const std::string& direction) {
  constexpr std::array<std::string_view, 6> words{"x", "y", "z", "-x", "-y", "-z"};
  const auto found = std::find(words.begin(), words.end(), direction);
  if (found == words.end()) throw input_error("--up", '"' + direction + '"', "x, y, z, -x, -y or -z");
  const auto index = static_cast<unsigned>(found - words.begin());
  turn_up(m, index % 3, index >= 3);
}

voxel_grid voxels_of_mesh(const convert_options& o, const progress_line& line) {
  mesh m = read_mesh(o.from);
  stand_up(m, o.up.value_or("y"));
  const unsigned resolution = *o.resolution;
  const double fit = o.fit.value_or(default_fit) * (resolution - 2.0 * o.margin.value_or(0)) / resolution;
  const auto show = [&](double share) { line.show("filling voxels", share); };
  return o.solid ? voxelise_solid(m, resolution, o.from.string(), fit, show) : voxelise_surface(m, resolution, fit, show);
}

voxel_grid voxels_of_octree(const convert_options& o) {
  const svo_image image = read_svo(o.from, widest_limits);
  const unsigned levels = describe(image, o.from.string(), widest_limits).levels;
  const std::uint64_t needed = std::uint64_t{1} << levels;
  const std::uint64_t resolution = o.resolution.value_or(0) == 0 ? needed : *o.resolution;
  if (needed > voxel_grid::most_resolution || needed > resolution)
    throw input_error(o.from.string(), fmt::format("{} voxels an edge", needed),
                      fmt::format("at most {}", std::min<std::uint64_t>(resolution, voxel_grid::most_resolution)));
  return voxels_of(image, static_cast<unsigned>(resolution));
}

voxel_grid load(const convert_options& o, const progress_line& line) {
  line.show("reading", 0);
  if (is_octree(o.from)) return voxels_of_octree(o);
  if (is_binvox(o.from)) return read_binvox(o.from, o.resolution.value_or(0));
  return voxels_of_mesh(o, line);
}

}  // namespace

std::string convert(const convert_options& o) {
  check_options(o);
  config::check_writable(o.to);
  const progress_line line(!o.quiet);
  const voxel_grid grid = load(o, line);
  const std::uint64_t filled = grid.count();
  const auto voxels = static_cast<double>(std::uint64_t{1} << (3 * grid.levels()));
  std::string told =
      fmt::format("{} voxels an edge, {} filled ({:.3f} %)\n", grid.resolution(), filled, 100 * static_cast<double>(filled) / voxels);
  line.show("writing", 1);
  if (o.to.extension() == ".binvox") {
    write_binvox(o.to, grid);
    return told;
  }
  const svo_image image = build_svo(grid, o.from.string());
  write_svo(o.to, image);
  unsigned address_bits = 1;
  while ((std::uint64_t{1} << address_bits) < image.words.size()) ++address_bits;
  told += fmt::format("octree of {} words, {} bytes: {} address bits\n", image.words.size(), 4 * image.words.size(), address_bits);
  if (const unsigned usual = svo_limits().address_bits; address_bits > usual)
    told += fmt::format("more than the {} of the usual design: --set memory.address_bits={}\n", usual, address_bits);
  return told;
}

}  // namespace rtusim
