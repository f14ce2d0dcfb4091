#include "scenes/triangles/bih_builder.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "modules/bih_core/bih_walk.h"
#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "scenes/meshes/bezier_patches.h"
#include "testbench/tests/random_bih.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/bih/";
constexpr std::int64_t grid = (std::int64_t{1} << 30) - 1;
constexpr std::int64_t any_word = std::numeric_limits<std::int64_t>::max();

using vertex = per_axis<std::int64_t>;

triangle_box box_of(const vertex& a, const vertex& b, const vertex& c) {
  triangle_box box;
  for (unsigned i = 0; i < 3; ++i) {
    box.lower[i] = std::min({a[i], b[i], c[i]});
    box.upper[i] = std::max({a[i], b[i], c[i]});
  }
  return box;
}

/// Moves a mesh's vertices to the grid. `tie`: added before rounding half to even, so small that only ties feel it.
std::vector<vertex> quantised(const std::vector<glm::dvec3>& vertices, double tie = 0) {
  glm::dvec3 least = vertices.front(), most = least;
  for (const glm::dvec3& v : vertices)
    for (int i = 0; i < 3; ++i) {
      least[i] = std::min(least[i], v[i]);
      most[i] = std::max(most[i], v[i]);
    }
  const glm::dvec3 size = most - least;
  const double scale = static_cast<double>(grid) / std::max({size.x, size.y, size.z});
  std::vector<vertex> on_grid;
  for (const glm::dvec3& v : vertices)
    for (int i = 0; i < 3; ++i) {
      if (i == 0) on_grid.emplace_back();
      on_grid.back()[static_cast<unsigned>(i)] = static_cast<std::int64_t>(std::nearbyint((v[i] - least[i]) * scale + tie));
    }
  return on_grid;
}

/// Two triangles on each face of a box: below and above on each axis.
void add_box(std::vector<triangle_box>& boxes, const vertex& lower, const vertex& upper) {
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned side = 0; side < 4; ++side) {
      triangle_box& box = boxes.emplace_back(triangle_box{lower, upper});
      if (side < 2)
        box.upper[axis] = lower[axis];
      else
        box.lower[axis] = upper[axis];
    }
}

std::vector<triangle_box> tetra() {
  const auto at = [](double share) { return static_cast<std::int64_t>(std::nearbyint(share * static_cast<double>(grid))); };
  const vertex v[4] = {{}, {at(.95), at(.05), at(1)}, {at(1), at(.9), at(.1)}, {at(.1), at(1), at(.85)}};
  return {box_of(v[0], v[1], v[2]), box_of(v[0], v[2], v[3]), box_of(v[0], v[3], v[1]), box_of(v[1], v[2], v[3])};
}

std::vector<triangle_box> cube() {
  std::vector<triangle_box> boxes;
  add_box(boxes, {0, 0, 0}, {grid, grid, grid});
  return boxes;
}

/// The teapot at 3 x 3 and a cube beside it.
std::vector<triangle_box> cubepot(double tie) {
  const std::string file = RTUSIM_SOURCE_DIR "/scenes/data/teapot.bpt";
  mesh m = tessellate(parse_bpt(config::read_file(file), file), 3);
  m.vertices.emplace_back(2.2, 2.2, 0.8);
  m.vertices.emplace_back(3.2, 3.2, 1.8);
  const std::vector<vertex> v = quantised(m.vertices, tie);
  std::vector<triangle_box> boxes;
  for (const auto& t : m.triangles)
    if (v[t[0]] != v[t[1]] && v[t[1]] != v[t[2]] && v[t[2]] != v[t[0]]) boxes.push_back(box_of(v[t[0]], v[t[1]], v[t[2]]));
  add_box(boxes, v[v.size() - 2], v.back());
  return boxes;
}

std::vector<triangle_box> random_boxes(test::rng& random, std::size_t count) {
  std::vector<triangle_box> boxes(count);
  const unsigned up = 10 + random() % 19;
  for (triangle_box& box : boxes)
    for (unsigned i = 0; i < 3; ++i) {
      const auto at = static_cast<std::int64_t>(random() % (1u << 30));
      box.lower[i] = random() % 8 == 0 ? 0 : at;
      box.upper[i] = std::min(grid, box.lower[i] + static_cast<std::int64_t>(random() % (1u << up)));
    }
  return boxes;
}

std::string refusal(const std::vector<triangle_box>& boxes, unsigned leaf_size, unsigned address_bits) {
  try {
    build_bih(boxes, leaf_size, address_bits, "m");
  } catch (const input_error& e) {
    return e.what();
  }
  return "accepted";
}

/// Whether a ray meets a box for sure: for more grid units than the core's roundings lose.
bool meets(const quantised_ray& ray, const triangle_box& box) {
  long double enter = 0, leave = 1e30L;
  for (unsigned i = 0; i < 3; ++i) {
    const long double per_unit = static_cast<long double>(ray.reciprocal[i]) / 65536;
    const long double a = static_cast<long double>(box.lower[i] - ray.position[i]) * per_unit;
    const long double b = static_cast<long double>(box.upper[i] - ray.position[i]) * per_unit;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter + 2 < leave;
}

}  // namespace

TEST_CASE("the golden hierarchies rebuilt from their triangles are the same words", "[bih_builder]") {
  struct row {
    const char* name;
    unsigned leaf_size;
    std::vector<triangle_box> boxes;
  };
  // 603 coordinates of the teapot are rounding ties: in double they come out so or so. These went down.
  const double down = -1e-6;
  const row table[] = {
      {"tetra_k1", 1, tetra()}, {"cube_k2", 2, cube()}, {"cubepot_k4", 4, cubepot(down)}, {"cubepot_k8", 8, cubepot(down)}};
  for (const row& r : table) {
    CAPTURE(r.name);
    const bih_memory wanted = read_bih(golden + "scenes/" + r.name, 10);
    const bih_memory built = build_bih(r.boxes, r.leaf_size, 10, r.name);
    CHECK(built.corner == wanted.corner);
    CHECK((built.words == wanted.words));
  }
}

TEST_CASE("the golden rays take as many clocks through the rebuilt teapot, but for its rounding ties", "[bih_builder]") {
  const bih_memory memory = build_bih(cubepot(0), 4, 10, "cubepot");
  const csv_table rays(golden + "bih_cubepot_k4_400.csv.gz");
  bih_walk walk(test::bih_as_built(), memory);
  std::int64_t clocks = 0, wanted = 0;
  for (std::size_t row = 0; row < rays.rows(); ++row) {
    const auto word = [&](const char* name) { return rays.number(row, rays.column(name), -any_word, any_word); };
    const quantised_ray ray{{word("pos_x"), word("pos_y"), word("pos_z")}, {}, {word("idir_x"), word("idir_y"), word("idir_z")}};
    clocks += static_cast<std::int64_t>(walk(ray, [](std::uint32_t, std::uint64_t) {}).cycles());
    wanted += word("clocks");
  }
  INFO(clocks << " clocks, " << wanted << " in the vectors");
  CHECK(std::abs(clocks - wanted) * 200 <= wanted);
}

TEST_CASE("every triangle is in one list, and a ray that meets its box finds it", "[bih_builder]") {
  test::rng random(5);
  bih_core_params p;
  p.address_bits = 12;
  std::uint64_t met = 0, found = 0, rays = 0, of = 0;
  for (int scene = 0; scene < 60; ++scene) {
    const std::vector<triangle_box> boxes = random_boxes(random, 1 + random() % 1'000);
    const unsigned leaf_size = 1 + random() % 16;
    const bih_memory memory = build_bih(boxes, leaf_size, p.address_bits, "random");
    std::vector<std::uint64_t> listed(memory.words[3].begin(), memory.words[3].begin() + static_cast<std::ptrdiff_t>(boxes.size()));
    std::sort(listed.begin(), listed.end());
    for (std::uint64_t i = 0; i < listed.size(); ++i) REQUIRE(listed[i] == i);
    bih_walk walk(p, memory);
    for (int number = 0; number < 100; ++number, ++rays) {
      quantised_ray ray;
      for (unsigned i = 0; i < 3; ++i) {
        ray.position[i] = static_cast<std::int64_t>(random() % (1u << 30));
        const std::int64_t direction = static_cast<std::int32_t>(random()) >> random() % 12;
        ray.reciprocal[i] = direction == 0 ? (std::int64_t{1} << 47) - 1 : (std::int64_t{1} << 47) / direction;
      }
      std::set<std::uint32_t> issued;
      const bih_outcome o = walk(ray, [&](std::uint32_t triangle, std::uint64_t) { issued.insert(triangle); });
      REQUIRE(issued.size() == o.triangles);
      for (std::uint32_t t = 0; t < boxes.size(); ++t) {
        if (!meets(ray, boxes[t])) continue;
        ++met;
        CAPTURE(scene, number, t);
        REQUIRE(issued.count(t) == 1);
      }
      found += o.triangles;
      of += boxes.size();
    }
  }
  CHECK(met > 1'000);
  CHECK(found < of / 2);
}

TEST_CASE("equal triangles are halved, and a leaf may hold them all", "[bih_builder]") {
  const triangle_box box{{1, 2, 3}, {4, 5, 9}};
  const std::vector<triangle_box> boxes(5, box);
  const bih_memory halved = build_bih(boxes, 1, 10, "m");
  CHECK(halved.corner == box.upper);
  CHECK(check_bih(build_bih(boxes, 5, 10, "m"), "m", {true, true}).leaves == 1);
  CHECK(halved.words[0][0] == make_inner(2, 1, 0, 0)[0]);
  CHECK(halved.words[1][0] == 9);
  CHECK(halved.words[2][0] == 3);
  const bih_summary summary = check_bih(halved, "m", {true, true});
  CHECK(summary.leaves == 5);
  CHECK(summary.levels == 4);
}

TEST_CASE("what can't be built is refused", "[bih_builder]") {
  test::rng random(7);
  const std::vector<triangle_box> many = random_boxes(random, 1'000);
  CHECK_THAT(refusal(many, 0, 10), Catch::Contains("m: at most 0 triangles a leaf; expected at least 1"));
  CHECK_THAT(refusal({}, 1, 10), Catch::Contains("m: no triangles"));
  CHECK(refusal(many, 100, 11) == "accepted");
  CHECK_THAT(refusal(many, 100, 10), Catch::Contains("1000 list words of 1000 triangles; expected at most 992 of each for "
                                                     "bih_core.address_bits = 10; 11 would do"));
  CHECK_THAT(refusal(many, 1, 10), Catch::Contains("m: 1999 nodes and 1000 list words") && Catch::EndsWith("11 would do"));
  CHECK_THAT(refusal(random_boxes(random, 140'000), 1, 10), Catch::EndsWith("18 bits are the most"));
  // Each split takes the outermost one away: x at 2^30, 2^29, ...; so on along y and z in what is left.
  std::vector<triangle_box> deep;
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned bit = 1; bit < 30; ++bit) {
      vertex v{};
      v[axis] = std::int64_t{1} << bit;
      deep.push_back({v, v});
    }
  CHECK_THAT(refusal(deep, 1, 10), Catch::Contains("a ray may push 32 entries on its way here; expected at most 31"));
}

TEST_CASE("the dragon fits the memories of the default design", "[bih_builder]") {
  const mesh m = read_mesh(RTUSIM_SOURCE_DIR "/scenes/data/dragon_res3.ply.gz");
  const std::vector<vertex> v = quantised(m.vertices);
  std::vector<triangle_box> boxes;
  for (const auto& t : m.triangles) boxes.push_back(box_of(v[t[0]], v[t[1]], v[t[2]]));
  bih_memory memory = build_bih(boxes, 8, bih_core_params{}.address_bits, "dragon");
  memory.triangles.resize(boxes.size());
  const bih_summary summary = check_bih(memory, "dragon");
  CHECK(summary.listed == boxes.size());
  CHECK(summary.inner_nodes > boxes.size() / 8);
  CHECK(summary.stack_entries < most_bih_stack_entries);
}

}  // namespace rtusim
