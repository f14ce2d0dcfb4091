#include "testbench/commands/convert_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/formats/svo_image.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/svo_builder.h"
#include "testbench/commands/info_command.h"
#include "testbench/pictures/voxel_views.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/";
const std::string data = RTUSIM_SOURCE_DIR "/scenes/data/";
const std::string cases = RTUSIM_SOURCE_DIR "/testbench/tests/cases/";

// A closed gear of quads: `teeth` teeth around z, with a bore, 2 across and 0.5 thick.
std::string gear(int teeth) {
  std::string s;
  const int corners = 4 * teeth;
  for (const double z : {-0.25, 0.25})
    for (int i = 0; i < corners; ++i) {
      const double angle = 6.283185307179586 * i / corners, outer = i % 4 == 1 || i % 4 == 2 ? 1.0 : 0.8;
      for (const double r : {outer, 0.35}) s += fmt::format("v {:.6f} {:.6f} {}\n", r * std::cos(angle), r * std::sin(angle), z);
    }
  for (int i = 0; i < corners; ++i) {
    const auto v = [&](int corner, int ring, int top) { return 1 + 2 * corners * top + 2 * ((i + corner) % corners) + ring; };
    s += fmt::format("f {} {} {} {}\n", v(0, 0, 0), v(1, 0, 0), v(1, 0, 1), v(0, 0, 1));
    s += fmt::format("f {} {} {} {}\n", v(1, 1, 0), v(0, 1, 0), v(0, 1, 1), v(1, 1, 1));
    s += fmt::format("f {} {} {} {}\n", v(0, 0, 1), v(1, 0, 1), v(1, 1, 1), v(0, 1, 1));
    s += fmt::format("f {} {} {} {}\n", v(1, 0, 0), v(0, 0, 0), v(0, 1, 0), v(1, 1, 0));
  }
  return s;
}

// The voxels between which something is filled along each axis.
std::array<std::array<double, 2>, 3> span(const std::filesystem::path& file) {
  const svo_summary s = describe(read_svo(file), file.string());
  std::array<std::array<double, 2>, 3> all{};
  for (std::size_t k = 0; k < 3; ++k) all[k] = {std::ldexp(s.lower[k], int(s.levels)), std::ldexp(s.upper[k], int(s.levels))};
  return all;
}

convert_options options(const std::filesystem::path& from, const std::filesystem::path& to, std::optional<unsigned> resolution = {}) {
  convert_options o;
  o.from = from;
  o.to = to;
  o.resolution = resolution;
  o.quiet = true;
  return o;
}

}  // namespace

TEST_CASE("convert: a gear, solid, with its axis up", "[convert]") {
  const test::scratch_folder folder;
  convert_options o = options(folder.file("gear.obj", gear(12)), folder / "gear.svo", 64);
  o.fit = 1;
  o.margin = 8;
  using spans = std::array<std::array<double, 2>, 3>;
  const spans z_up{{{7, 57}, {25, 39}, {7, 57}}}, y_up{{{7, 57}, {7, 57}, {25, 39}}}, x_up{{{7, 57}, {7, 57}, {25, 39}}};
  const std::pair<const char*, spans> ways[] = {{"z", z_up}, {"-z", z_up}, {"y", y_up}, {"-y", y_up}, {"x", x_up}};
  for (const auto& [way, expected] : ways) {
    CAPTURE(way);
    o.up = way;
    CHECK_THAT(convert(o), Catch::StartsWith("64 voxels an edge, "));
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t side = 0; side < 2; ++side) CHECK(std::abs(span(o.to)[k][side] - expected[k][side]) <= 1);
  }
  const svo_summary surface = describe(read_svo(o.to), "surface");
  o.solid = true;
  convert(o);
  CHECK(describe(read_svo(o.to), "solid").filled_voxels > 2 * surface.filled_voxels);
}

TEST_CASE("convert: a mesh gives what a run makes of it", "[convert]") {
  const test::scratch_folder folder;
  const auto built = load_octree(data + "bunny.obj", 32, 10, {});
  convert(options(data + "bunny.obj", folder / "a.svo", 32));
  CHECK((read_svo(folder / "a.svo").words == built.words));
  convert(options(data + "bunny.obj", folder / "a.binvox", 32));
  CHECK((load_octree(folder / "a.binvox", 0, 10, {}).words == built.words));
}

TEST_CASE("convert: octrees and voxels there and back", "[convert]") {
  const test::scratch_folder folder;
  convert(options(golden + "dragon_128.svo", folder / "a.binvox"));
  // The root cube reaches from -1 to 1.
  CHECK_THAT(config::read_file(folder / "a.binvox"), Catch::StartsWith("#binvox 1\ndim 128 128 128\ntranslate -1 -1 -1\nscale 2\ndata\n"));
  convert(options(folder / "a.binvox", folder / "a.svo"));
  CHECK((config::read_file(folder / "a.svo") == config::read_file(golden + "dragon_128.svo")));
  convert(options(folder / "a.svo", folder / "b.binvox"));
  CHECK((config::read_file(folder / "a.binvox") == config::read_file(folder / "b.binvox")));
  // Finer voxels are the same octree.
  convert(options(folder / "a.svo", folder / "c.binvox", 256));
  convert(options(folder / "c.binvox", folder / "c.svo"));
  CHECK((config::read_file(folder / "a.svo") == config::read_file(folder / "c.svo")));
}

TEST_CASE("convert: an octree does not keep a size that is no power of two, and says so", "[convert]") {
  using Catch::Contains;
  const test::scratch_folder folder;
  const auto bytes = [](const std::filesystem::path& file) { return config::read_file(file); };
  // Voxels in opposite corners, so that the octree has the cube's levels, with and without a place of its own.
  const auto given = [&](unsigned edge, const std::string& place) {
    const unsigned between = edge * edge * edge - 2;
    std::string runs("\1\1", 2);
    for (unsigned left = between, length; left != 0; left -= length) runs += {'\0', static_cast<char>(length = std::min(left, 255U))};
    return folder.file("given.binvox", fmt::format("#binvox 1\ndim {0} {0} {0}\n{1}data\n{2}\1\1", edge, place, runs));
  };
  for (const unsigned edge : {3U, 5U, 6U, 24U, 33U, 100U}) {
    CAPTURE(edge);
    unsigned fine = 4;
    while (fine < edge) fine *= 2;
    const double lower = -1 + 2.0 * ((fine - edge) / 2) / fine;
    const auto file = given(edge, fmt::format("translate {0} {0} {0}\nscale {1}\n", lower, 2.0 * edge / fine));
    CHECK_THAT(convert(options(file, folder / "a.svo")),
               Contains(fmt::format("the {} voxels an edge stand in the middle of the octree's {}; --resolution {} on the way back", edge,
                                    fine, edge)) &&
                   Contains("an octree does not keep where they lie"));
    convert(options(folder / "a.svo", folder / "b.binvox", edge));
    CHECK((bytes(folder / "b.binvox") == bytes(file)));
    convert(options(folder / "a.svo", folder / "c.binvox"));
    CHECK_THAT(info_text(folder / "c.binvox"), Catch::StartsWith(fmt::format("voxels in a cube of {} an edge;", fine)));
    CHECK_THROWS_WITH(convert(options(folder / "a.svo", folder / "b.binvox", edge == 3 ? 2 : edge - 1)), Contains("; expected "));
    // Of voxels nothing is lost.
    convert(options(file, folder / "d.binvox"));
    CHECK((bytes(folder / "d.binvox") == bytes(file)));
  }
  CHECK_THAT(convert(options(given(6, ""), folder / "a.svo", 32)),
             Contains("the 6 voxels an edge stand in the middle of the octree's 32\n") && Contains("translate 0 0 0, scale 1\n"));
  CHECK_THAT(convert(options(given(8, "translate -1 -1 -1\nscale 2\n"), folder / "a.svo")), !Contains("middle") && !Contains("keep"));
  CHECK_THAT(convert(options(given(8, "translate -1 -1 -1.5\nscale 2\n"), folder / "a.svo")),
             !Contains("middle") && Contains("-1 -1 -1.5"));
  // The middle, but not all of what is filled.
  convert(options(given(8, ""), folder / "a.svo"));
  CHECK_THROWS_WITH(convert(options(folder / "a.svo", folder / "b.binvox", 7)),
                    Contains("--resolution: 7, and 1 filled voxels outside the middle of 8; expected 8"));
}

TEST_CASE("convert: a solid with faces turned against their neighbours is told of", "[convert]") {
  const test::scratch_folder folder;
  convert_options o = options(cases + "mesh_cube_one_turned.obj", folder / "a.binvox", 32);
  o.solid = true;
  o.fit = 1;
  CHECK(convert(o) ==
        "2 of 12 triangles were turned against their neighbours, and are turned back\n32 voxels an edge, 32768 filled (100.000 %)\n");
  o.from = cases + "mesh_cube.obj";
  CHECK(convert(o) == "32 voxels an edge, 32768 filled (100.000 %)\n");
  o.from = cases + "mesh_cubes_overlapping.obj";
  CHECK(convert(o) == "32 voxels an edge, 17522 filled (53.473 %)\n");
}

TEST_CASE("convert and info: endings in capitals", "[convert]") {
  const test::scratch_folder folder;
  CHECK_THAT(info_text(cases + "UPPER.BINVOX"), Catch::Contains("           7 voxels filled"));
  convert(options(cases + "UPPER.BINVOX", folder / "A.SVO"));
  convert(options(folder / "A.SVO", folder / "B.BinVox"));
  CHECK_THAT(info_text(folder / "B.BinVox"), Catch::Contains("           7 voxels filled"));
  std::filesystem::copy(data + "dragon_res3.ply.gz", folder / "DRAGON.PLY.GZ");
  CHECK_THAT(info_text(folder / "DRAGON.PLY.GZ"), Catch::StartsWith("mesh"));
  std::filesystem::copy(golden + "dragon_8.svo", folder / "DRAGON.Svo");
  CHECK(load_octree(folder / "DRAGON.Svo", 0, 10, {}).words.size() == 35);
  CHECK(has_patches("TEAPOT.BPT"));
  CHECK(has_patches("teapot.bpt.GZ"));
  CHECK_FALSE(has_patches("teapot.bpt.zip"));
}

TEST_CASE("convert: what can't be done is refused, and nothing is left", "[convert]") {
  const test::scratch_folder folder, inputs;
  const auto refused = [&](const convert_options& o, const std::string& text) {
    try {
      convert(o);
      FAIL("accepted");
    } catch (const input_error& e) {
      CHECK_THAT(e.what(), Catch::Contains(text));
    }
    CHECK(folder.empty());
  };
  const auto of_bunny = [&](const auto& change) {
    convert_options o = options(data + "bunny.obj", folder / "a.svo", 32);
    change(o);
    return o;
  };
  refused(of_bunny([](auto& o) { o.resolution.reset(); }), "convert: no --resolution; expected a power of two from 2 to 1024");
  refused(of_bunny([](auto& o) { o.resolution = 48; }), "--resolution: 48; expected a power of two");
  refused(of_bunny([](auto& o) { o.resolution = 2048; }), "--resolution: 2048");
  refused(of_bunny([](auto& o) { o.up = "w"; }), "--up: \"w\"; expected x, y, z, -x, -y or -z");
  refused(of_bunny([](auto& o) { o.margin = 16; }), "--margin: 16; expected less than half of the 32");
  refused(of_bunny([](auto& o) { o.fit = 0; }), "--fit: 0");
  refused(of_bunny([](auto& o) { o.fit = 1.5; }), "--fit: 1.5; expected above 0, at most 1");
  refused(of_bunny([](auto& o) { o.fit = std::nan(""); }), "--fit: nan");
  refused(of_bunny([&](auto& o) { o.to = folder / "a.ply"; }), "a.ply: an output ending in \".ply\"; expected .svo or .binvox");
  refused(of_bunny([&](auto& o) { o.to = folder / "none" / "a.svo"; }), "its folder does not exist");
  refused(of_bunny([&](auto& o) { o.from = data + "none.obj"; }), "none.obj: no such file");
  refused(of_bunny([&](auto& o) { o.from = golden + "dragon_128.svo"; }), "128 voxels an edge; expected at most 32");
  refused(of_bunny([&](auto& o) { o.from = golden + "dragon_8.svo", o.solid = true; }), "--solid: given with ");
  convert_options leaking = options(data + "teapot.bpt", folder / "a.svo", 32);
  leaking.solid = true;
  refused(leaking, "teapot.bpt: 160 open edges, the first from (1.4, 2.4, 0)");
  refused(options(golden + "deep_4096.svo", folder / "a.binvox"), "4096 voxels an edge; expected at most 1024");
  refused(options(inputs.file("a.binvox", "#binvox 1\ndim 2 2 2\ndata\n" + std::string("\0\x08", 2)), folder / "a.svo"),
          "no voxel is filled");
}

TEST_CASE("info: octrees, voxels and meshes", "[convert]") {
  const test::scratch_folder folder;
  CHECK(info_text(golden + "dragon_8.svo") ==
        "octree of 3 levels: 8 voxels an edge\n         140 bytes\n          35 nodes\n           0 far words\n         108 leaves\n"
        "         129 voxels filled (25.195 % of the cube)\nx          0 to 7, the first and the last voxel filled\n"
        "y          1 to 6, the first and the last voxel filled\nz          2 to 5, the first and the last voxel filled\n");
  convert(options(golden + "dragon_8.svo", folder / "a.binvox"));
  CHECK_THAT(info_text(folder / "a.binvox"),
             Catch::StartsWith("voxels in a cube of 8 an edge; as an octree of 3 levels, 8 voxels an edge:\n") &&
                 Catch::Contains(" 108 leaves\n"));
  folder.file("none.binvox", "#binvox 1\ndim 2 2 2\ndata\n" + std::string("\0\x08", 2));
  CHECK(info_text(folder / "none.binvox") ==
        "voxels in a cube of 2 an edge, none filled\n           1 long, from 0 0 0: where the cube lies\n");
  CHECK_THAT(info_text(data + "teapot.bpt"), Catch::Contains(" 160 open edges\n"));
}

TEST_CASE("info: the slices stand as on a drawing", "[convert]") {
  voxel_grid grid(4);
  grid.fill(0, 3, 2);  // in the slice of z: to the left, above
  grid.fill(2, 0, 3);  // in that of x, z to the left: to the left, below
  grid.fill(3, 2, 0);  // in that of y, z downwards: to the right, above
  const rgb_picture sheet = voxel_views(grid, {0, 0, 0}, {1, 1, 1});
  REQUIRE(sheet.samples.size() == std::size_t{3} * sheet.width * sheet.height);
  // The eighths of a panel's edge, from above left; panels from above left, too.
  const auto is_filled = [&](unsigned column, unsigned row, unsigned x, unsigned y) {
    const unsigned panel = sheet.width / 2, px = column * panel + panel * x / 8, py = row * panel + panel * y / 8;
    return sheet.samples[3 * (std::size_t{py} * sheet.width + px)] < 100;
  };
  for (unsigned j = 1; j < 8; j += 2)
    for (unsigned i = 1; i < 8; i += 2) {
      CAPTURE(i, j);
      CHECK(is_filled(0, 1, i, j) == (i == 1 && j == 1));
      CHECK(is_filled(1, 1, i, j) == (i == 1 && j == 7));
      CHECK(is_filled(0, 0, i, j) == (i == 7 && j == 1));
    }
}

TEST_CASE("info: the view from the right front shows the nearest faces", "[convert]") {
  test::rng random(5);
  voxel_grid grid(4);
  std::vector<glm::dvec3> filled;  // lower corners
  for (unsigned x = 0; x < 4; ++x)
    for (unsigned y = 0; y < 4; ++y)
      for (unsigned z = 0; z < 4; ++z)
        if (random() % 3 == 0) {
          grid.fill(x, y, z);
          filled.emplace_back(x, y, z);
        }
  // From above to the right, along a fixed way, with the box of all voxels and a little more in the panel.
  const glm::dvec3 way = glm::normalize(glm::dvec3(-0.62, -0.52, -1.0)), right = glm::normalize(glm::cross(way, {0, 1, 0}));
  const glm::dvec3 up = glm::cross(right, way), centre(2.0), half(2.0);
  const double reach = 1.04 * std::max(glm::dot(glm::abs(right), half), glm::dot(glm::abs(up), half));
  const rgb_picture sheet = voxel_views(grid, {0, 0, 0}, {1, 1, 1});
  const unsigned gap = 8, panel = (sheet.width - 3 * gap) / 2;
  // Each face's colour is found where it is seen first, and must then be its alone: ground, and the faces to +x, +y, +z.
  std::array<std::array<int, 3>, 4> colours{{{-1, -1, -1}, {-1, -1, -1}, {-1, -1, -1}, {-1, -1, -1}}};
  std::array<unsigned, 4> seen{};
  unsigned wrong = 0;
  for (unsigned py = 0; py < panel; py += 3)
    for (unsigned px = 0; px < panel; px += 3) {
      const double a_pixel = 2 * reach / panel;
      const glm::dvec3 from = centre + right * ((px + 0.5) * a_pixel - reach) - up * ((py + 0.5) * a_pixel - reach) - way * 20.0;
      std::size_t face = 0;
      double nearest = 1e9;
      for (const glm::dvec3& corner : filled) {
        // The way has no positive component: a box is entered through its upper faces.
        const glm::dvec3 in = (corner + 1.0 - from) / way, out = (corner - from) / way;
        const double enters = std::max({in.x, in.y, in.z});
        if (enters >= std::min({out.x, out.y, out.z}) || enters >= nearest) continue;
        nearest = enters;
        face = in.x == enters ? 1 : in.y == enters ? 2 : 3;
      }
      ++seen[face];
      const std::size_t at = 3 * (std::size_t{gap + py} * sheet.width + gap + panel + gap + px);
      const std::array<int, 3> shown{sheet.samples[at], sheet.samples[at + 1], sheet.samples[at + 2]};
      if (colours[face][0] < 0) colours[face] = shown;
      wrong += shown != colours[face];
    }
  CHECK(wrong <= 2);  // on edges
  for (const unsigned pixels : seen) CHECK(pixels > 1'000);
  // Lit from above, more from the front than from the side.
  CHECK(colours[0] == std::array<int, 3>{244, 244, 240});
  CHECK(colours[2][0] > colours[3][0]);
  CHECK(colours[3][0] > colours[1][0]);
  CHECK(colours[2][0] < colours[0][0]);
}

}  // namespace rtusim
