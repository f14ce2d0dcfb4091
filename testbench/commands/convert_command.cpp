#include "testbench/commands/convert_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "modules/formats/svo_image.h"
#include "scenes/meshes/mesh.h"
#include "scenes/meshes/orientation.h"
#include "scenes/voxels/binvox.h"
#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/commands/options.h"
#include "testbench/run/progress_line.h"

namespace rtusim {
namespace {

std::string resolutions() { return fmt::format("a power of two from {} to {}", voxel_grid::least_resolution, voxel_grid::most_resolution); }

bool writes_binvox(const convert_options& o) { return is_binvox(o.to); }

void check_options(const convert_options& o) {
  if (const std::string ending = config::ending_of(o.to); ending != ".svo" && ending != ".binvox")
    throw input_error(o.to.string(), fmt::format("an output ending in \"{}\"", o.to.extension().string()), ".svo or .binvox");
  if (o.resolution && is_octree(o.from) && writes_binvox(o)) {
    if (*o.resolution < 1 || *o.resolution > voxel_grid::most_resolution)
      throw input_error("--resolution", std::to_string(*o.resolution), fmt::format("1 to {}", voxel_grid::most_resolution));
  } else if (o.resolution && !voxel_grid::is_resolution(*o.resolution)) {
    throw input_error("--resolution", std::to_string(*o.resolution), resolutions());
  }
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

// Adds to `told` what was done to the mesh.
voxel_grid voxels_of_mesh(const convert_options& o, const progress_line& line, std::string& told) {
  mesh m = read_mesh(o.from);
  stand_up(m, o.up.value_or("y"));
  const unsigned resolution = *o.resolution;
  const double fit = o.fit.value_or(default_fit) * (resolution - 2.0 * o.margin.value_or(0)) / resolution;
  const auto show = [&](double share) { line.show("filling voxels", share); };
  if (!o.solid) return voxelise_surface(m, resolution, fit, show);
  if (const std::uint64_t turned = turn_alike(m); turned != 0)
    told += fmt::format("{} of {} triangles were turned against their neighbours, and are turned back\n", turned, m.triangles.size());
  return voxelise_solid(m, resolution, o.from.string(), fit, show);
}

voxel_cube voxels_of_octree(const convert_options& o) {
  const svo_image image = read_svo(o.from, widest_limits);
  const unsigned levels = describe(image, o.from.string(), widest_limits).levels;
  const std::uint64_t needed = std::uint64_t{1} << levels;
  std::uint64_t resolution = o.resolution ? voxel_grid::least_resolution : needed;
  while (resolution < o.resolution.value_or(0)) resolution *= 2;
  if (needed > voxel_grid::most_resolution || needed > resolution)
    throw input_error(o.from.string(), fmt::format("{} voxels an edge", needed),
                      fmt::format("at most {}", std::min<std::uint64_t>(resolution, voxel_grid::most_resolution)));
  voxel_cube cube(voxels_of(image, static_cast<unsigned>(resolution)));
  cube.set_edge(o.resolution.value_or(cube.edge));
  if (const std::uint64_t outside = cube.grid.count() - cube.count(); outside != 0)
    throw input_error("--resolution", fmt::format("{}, and {} filled voxels outside the middle of {}", cube.edge, outside, resolution),
                      fmt::format("{}, or an octree whose voxels keep to the middle", resolution));
  return cube;
}

voxel_cube load(const convert_options& o, const progress_line& line, std::string& told) {
  line.show("reading", 0);
  if (is_octree(o.from)) return voxels_of_octree(o);
  if (!is_binvox(o.from)) return voxel_cube(voxels_of_mesh(o, line, told));
  voxel_cube cube = read_binvox(o.from, o.resolution.value_or(0));
  if (o.resolution && writes_binvox(o)) cube.set_edge(*o.resolution);
  return cube;
}

// What an octree does not keep of the cube.
std::string lost_text(const voxel_cube& cube) {
  std::string text;
  if (const unsigned resolution = cube.grid.resolution(); cube.edge != resolution) {
    text += fmt::format("the {} voxels an edge stand in the middle of the octree's {}", cube.edge, resolution);
    unsigned usual = voxel_grid::least_resolution;
    while (usual < cube.edge) usual *= 2;
    if (usual == resolution) text += fmt::format("; --resolution {} on the way back to a .binvox gives them alone", cube.edge);
    text += '\n';
  }
  const voxel_cube root{voxel_grid(voxel_grid::least_resolution)};
  if (cube.translate != root.translate || cube.scale != root.scale)
    text += fmt::format("an octree does not keep where they lie: translate {}, scale {}\n", fmt::join(cube.translate, " "), cube.scale);
  return text;
}

}  // namespace

std::string convert(const convert_options& o) {
  check_options(o);
  config::check_writable_apart({o.to}, {o.from});
  const config::input_ledger read;
  const progress_line line(!o.quiet);
  std::string told;
  const voxel_cube cube = load(o, line, told);
  config::check_apart({o.to}, read.names());  // a mesh may have more files than one
  const std::uint64_t filled = cube.count();
  const double voxels = std::pow(cube.edge, 3);
  told += fmt::format("{} voxels an edge, {} filled ({:.3f} %)\n", cube.edge, filled, 100 * static_cast<double>(filled) / voxels);
  line.show("writing", 1);
  if (writes_binvox(o)) {
    write_binvox(o.to, cube);
    return told;
  }
  const svo_image image = build_svo(cube.grid, o.from.string());
  write_svo(o.to, image);
  told += lost_text(cube);
  unsigned address_bits = 1;
  while ((std::uint64_t{1} << address_bits) < image.words.size()) ++address_bits;
  told += fmt::format("octree of {} words, {} bytes: {} address bits\n", image.words.size(), 4 * image.words.size(), address_bits);
  if (const unsigned usual = svo_limits().address_bits; address_bits > usual)
    told += fmt::format("more than the {} of the usual design: --set memory.address_bits={}\n", usual, address_bits);
  return told;
}

void add_convert(CLI::App& program) {
  auto options = std::make_shared<convert_options>();
  convert_options& o = *options;
  CLI::App& app =
      add_command(program, "convert", "make an octree or voxels of a mesh, or one of the other", options, [](const convert_options& asked) {
        const std::string text = convert(asked);
        if (!asked.quiet) fmt::print(config::stream_beside({asked.to}), "{}", text);
      });
  app.add_option("FROM", o.from, "a mesh, voxels (.binvox) or an octree (.svo)")->required()->type_name("");
  app.add_option("TO", o.to, "OUT.svo or OUT.binvox")->required()->type_name("");
  add_number(app, "--resolution", o.resolution, "N", "voxels an edge, a power of two up to 1024");
  app.add_flag("--solid", o.solid, "the inside, too, of a closed mesh");
  app.add_option("--up", o.up, "what points up in the mesh: x, y (usual), z, -x, -y or -z")->type_name("AXIS");
  add_number(app, "--margin", o.margin, "M", "voxels left free at each face of the cube (0)");
  const auto read_fit = [&o](const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      throw input_error("--fit", '"' + text + '"', "a number above 0, at most 1");
    o.fit = value;
  };
  app.add_option_function<std::string>("--fit", read_fit, "share of the rest that the mesh's longest edge takes (0.98)")->type_name("F");
  app.add_flag("--quiet", o.quiet, "no summary");
  app.footer("Example: rtusim convert scenes/data/bunny.obj bunny.svo --resolution 128 --solid");
}

}  // namespace rtusim
