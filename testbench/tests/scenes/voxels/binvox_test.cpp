#include "scenes/voxels/binvox.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/formats/svo_image.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

const std::string models = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";
const std::string data = RTUSIM_SOURCE_DIR "/scenes/data/";
const std::string cases = RTUSIM_SOURCE_DIR "/testbench/tests/cases/";

std::string run(int value, int length) { return {static_cast<char>(value), static_cast<char>(length)}; }

std::string header(const std::string& dim, const std::string& version = "1") { return "#binvox " + version + "\ndim " + dim + "\ndata\n"; }

// The message with which a file is refused, without its folder.
std::string refusal(const std::string& bytes, unsigned resolution = 0) {
  const test::scratch_folder folder;
  try {
    read_binvox(folder.file("a.binvox", bytes), resolution);
  } catch (const input_error& e) {
    return std::string(e.what()).substr((folder / "").string().size());
  }
  return "accepted";
}

voxel_grid random_grid(unsigned resolution, unsigned seed) {
  test::rng random(seed);
  voxel_grid grid(resolution);
  for (unsigned n = 0; n < resolution * resolution * 3; ++n) grid.fill(random() % resolution, random() % resolution, random() % resolution);
  grid.fill_cube(grid.levels() - 1, 3);
  return grid;
}

}  // namespace

TEST_CASE("binvox: y is the fastest, then z, then x", "[binvox]") {
  const test::scratch_folder folder;
  const std::string bytes =
      "#binvox 1\ndim 4 4 4\ntranslate -0.1 2e-3 7\nscale 7.24632\ndata\n" + run(0, 6) + run(1, 2) + run(0, 40) + run(1, 1) + run(0, 15);
  const voxel_grid grid = read_binvox(folder.file("a.binvox", bytes)).grid;
  CHECK(grid.resolution() == 4);
  CHECK(grid.count() == 3);
  CHECK(grid.at(0, 2, 1));
  CHECK(grid.at(0, 3, 1));
  CHECK(grid.at(3, 0, 0));

  write_binvox(folder / "b.binvox", voxel_cube(grid));
  CHECK(config::read_file(folder / "b.binvox") ==
        "#binvox 1\ndim 4 4 4\ntranslate -1 -1 -1\nscale 2\ndata\n" + run(0, 6) + run(1, 2) + run(0, 40) + run(1, 1) + run(0, 15));
}

TEST_CASE("binvox: an edge that is no power of two stands in the middle", "[binvox]") {
  const test::scratch_folder folder;
  const auto file = folder.file("a.binvox", header("3 3 3") + run(1, 27));
  const voxel_grid grid = read_binvox(file).grid;
  CHECK(grid.resolution() == 4);
  CHECK(grid.count() == 27);
  CHECK(grid.at(0, 0, 0));
  CHECK_FALSE(grid.at(3, 0, 0));
  const voxel_grid wider = read_binvox(file, 16).grid;
  CHECK(wider.resolution() == 16);
  CHECK(wider.count() == 27);
  CHECK(wider.at(6, 6, 6));
  CHECK(wider.at(8, 8, 8));
  CHECK(read_binvox(folder.file("one.binvox", header("1 1 1") + run(1, 1))).grid.count() == 1);
  CHECK(read_binvox(folder.file("two.binvox", header("2 2 2", "2") + run(77, 4) + run(0, 4))).grid.count() == 4);
}

TEST_CASE("binvox: a header's comments, blank lines and blanks, its lines in any order", "[binvox]") {
  const test::scratch_folder folder;
  const std::string voxels = run(0, 9) + run(1, 1) + run(0, 54);
  for (const std::string& lines :
       {std::string("dim 4 4 4\ndata\n"), std::string("# made by hand\ndim 4 4 4\ndata\n"), std::string("\n\ndim 4 4 4\n\ndata\n"),
        std::string("scale 2\ntranslate 1 2 3\ndim 4 4 4\ndata\n"), std::string("translate 1 2 3\n#dim 9 9 9\ndim 4 4 4\nscale 2\ndata\n"),
        std::string("  dim\t4  4 4 \n \t\n  # data\r\n\r\nscale 2 \ndata \r\n"), "#" + std::string(3000, 'x') + "\ndim 4 4 4\ndata\n"}) {
    CAPTURE(lines);
    const voxel_cube cube = read_binvox(folder.file("a.binvox", "#binvox 1\n" + lines + voxels));
    CHECK(cube.edge == 4);
    CHECK(cube.grid.count() == 1);
    CHECK(cube.grid.at(0, 1, 2));
    CHECK(cube.scale == (lines.find("scale") != lines.npos ? 2 : 1));
    CHECK(cube.translate[2] == (lines.find("translate") != lines.npos ? 3 : 0));
  }
}

TEST_CASE("binvox: files of other makers", "[binvox]") {
  const voxel_cube commented = read_binvox(cases + "binvox_generated_by_line.binvox");
  CHECK(commented.edge == 8);
  CHECK(commented.count() == 1);
  CHECK(commented.grid.at(1, 2, 3));
  const voxel_cube odd = read_binvox(cases + "binvox_not_power_of_two.binvox");
  CHECK(odd.edge == 6);
  CHECK(odd.grid.resolution() == 8);
  CHECK(odd.count() == 2);
}

TEST_CASE("binvox: edge and place stay", "[binvox]") {
  const test::scratch_folder folder;
  for (const unsigned edge : {1U, 2U, 3U, 6U, 24U, 100U}) {
    CAPTURE(edge);
    test::rng random(edge);
    std::string bytes = fmt::format("#binvox 1\ndim {0} {0} {0}\ntranslate -0.1 2e-05 7\nscale 7.24632\ndata\n", edge);
    int value = 0;
    for (unsigned left = edge * edge * edge, length; left != 0; left -= length, value ^= 1)
      bytes += run(value, static_cast<int>(length = std::min(left, 1 + random() % 255U)));
    const auto file = folder.file("a.binvox", bytes);
    write_binvox(folder / "b.binvox", read_binvox(file));
    CHECK((config::read_file(folder / "b.binvox") == bytes));
    write_binvox(folder / "b.binvox", read_binvox(file, 128));
    CHECK((config::read_file(folder / "b.binvox") == bytes));
  }
  // A cube that takes in more voxels lies where it lay.
  voxel_cube cube = read_binvox(folder.file("a.binvox", "#binvox 1\ndim 3 3 3\ntranslate 10 20 30\nscale 6\ndata\n" + run(1, 27)), 8);
  CHECK(cube.first() == 2);
  cube.set_edge(8);
  CHECK(cube.translate == std::array<double, 3>{6, 16, 26});
  CHECK(cube.scale == 16);
  CHECK(cube.count() == 27);
  cube.set_edge(2);
  CHECK(cube.translate == std::array<double, 3>{12, 22, 32});
  CHECK(cube.scale == 4);
  CHECK(cube.count() == 8);
}

TEST_CASE("binvox: there and back", "[binvox]") {
  const test::scratch_folder folder;
  for (const unsigned resolution : {2U, 4U, 16U, 64U, 128U}) {
    CAPTURE(resolution);
    const voxel_grid grid = random_grid(resolution, resolution);
    write_binvox(folder / "a.binvox", voxel_cube(grid));
    const voxel_grid read = read_binvox(folder / "a.binvox").grid;
    CHECK((read == grid));
    const voxel_grid from_octree = voxels_of(build_svo(read, "random"), resolution);
    write_binvox(folder / "b.binvox", voxel_cube(from_octree));
    CHECK((config::read_file(folder / "a.binvox") == config::read_file(folder / "b.binvox")));
  }
  for (const char* name : {"dragon_32", "dragon_128", "rand_16_far"}) {
    CAPTURE(name);
    const svo_image octree = read_svo(models + name + ".svo");
    const unsigned resolution = 1U << describe(octree, name).levels;
    write_binvox(folder / "a.binvox", voxel_cube(voxels_of(octree, resolution)));
    const voxel_grid grid = read_binvox(folder / "a.binvox").grid;
    CHECK((voxels_of(build_svo(grid, name), resolution) == voxels_of(octree, resolution)));
    // The dragons are built as we build; the other was made to have far pointers.
    if (std::string(name) != "rand_16_far") CHECK((build_svo(grid, name).words == octree.words));
  }
}

TEST_CASE("binvox: a file that lies is refused with its place", "[binvox]") {
  using Catch::Matchers::StartsWith;
  CHECK_THAT(refusal(""), StartsWith("a.binvox:1: \"\"; expected a header"));
  CHECK_THAT(refusal("garbage"), StartsWith("a.binvox:1: \"garbage\""));
  CHECK_THAT(refusal(std::string(1000, 'x')), StartsWith("a.binvox:1: \"xxx"));
  CHECK_THAT(refusal("#binvox 3\n"), StartsWith("a.binvox:1: version 3; expected 1 or 2"));
  CHECK_THAT(refusal("#binvox\n"), StartsWith("a.binvox:1: \"\"; expected the version"));
  CHECK_THAT(refusal(header("4 4 5")), StartsWith("a.binvox:2: \"dim 4 4 5\"; expected a cube"));
  CHECK_THAT(refusal(header("4 4")), StartsWith("a.binvox:2: \"\"; expected three numbers"));
  CHECK_THAT(refusal(header("0 0 0")), StartsWith("a.binvox:2: \"dim 0 0 0\""));
  CHECK_THAT(refusal(header("-1 -1 -1")), StartsWith("a.binvox:2: \"-1\""));
  CHECK_THAT(refusal(header("1025 1025 1025")),
             StartsWith("a.binvox:2: \"dim 1025 1025 1025\"; expected a cube, three times the same from 1"));
  CHECK_THAT(refusal(header("4294967297 1 1")), StartsWith("a.binvox:2: \"4294967297\""));
  CHECK_THAT(refusal("#binvox 1\ndata\n"), StartsWith("a.binvox:2: data; expected a line dim"));
  CHECK_THAT(refusal("#binvox 1\ndim 4 4 4\nscale nan\ndata\n"), StartsWith("a.binvox:3: \"scale nan\""));
  CHECK_THAT(refusal("#binvox 1\ndim 4 4 4\ndim 8 8 8\ndata\n"), StartsWith("a.binvox:3: \"dim 8 8 8\"; expected one line dim"));
  CHECK_THAT(refusal("#binvox 1\ndim 4 4 4 4\ndata\n"), StartsWith("a.binvox:2: \"dim 4 4 4 4\"; expected nothing after dim 4 4 4"));
  CHECK_THAT(refusal("# binvox 1\ndim 4 4 4\ndata\n"), StartsWith("a.binvox:1: \"# binvox 1\"; expected #binvox 1"));
  CHECK_THAT(refusal("#binvox 1\ndim 4 4 4\ncolour red\n"), StartsWith("a.binvox:3: \"colour red\""));
  CHECK_THAT(refusal(header("1024 1024 1024")), StartsWith("a.binvox: 0 voxels; expected 1073741824, as its header claims"));
  CHECK_THAT(refusal(header("4 4 4") + run(1, 63)), StartsWith("a.binvox: 63 voxels; expected 64"));
  CHECK_THAT(refusal(header("4 4 4") + run(1, 65)), StartsWith("a.binvox: byte 26: voxel 65; expected 64"));
  CHECK_THAT(refusal(header("4 4 4") + run(1, 64) + run(0, 1)), StartsWith("a.binvox: byte 28: voxel 65"));
  CHECK_THAT(refusal(header("4 4 4") + run(2, 64)), StartsWith("a.binvox: byte 25: the value 2; expected 0 or 1"));
  CHECK_THAT(refusal(header("4 4 4") + run(1, 0)), StartsWith("a.binvox: byte 26: a run of 0 voxels"));
  CHECK_THAT(refusal(header("4 4 4") + run(1, 64) + "\n"), StartsWith("a.binvox: a value without its run"));
  CHECK_THAT(refusal(header("8 8 8"), 4), StartsWith("a.binvox: 8 voxels an edge; expected at most the resolution of 4"));
}

}  // namespace rtusim
