#include "scenes/triangles/quantised_triangles.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/numeric/fixed_point.h"
#include "scenes/meshes/bezier_patches.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

using row = std::array<std::int64_t, 10>;

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/bih/scenes/";

/// The words of a triangle memory, as far as it is used.
std::vector<row> read_triangles(const std::string& scene) {
  std::istringstream words(config::read_file(golden + scene + "/tri_ram.txt.gz"));
  words >> std::hex;
  std::vector<row> rows;
  for (row r; words;) {
    for (std::int64_t& word : r) {
      std::uint64_t bits = 0;
      words >> bits;
      word = numeric::wrap(static_cast<std::int64_t>(bits), 36);
    }
    if (r == row{}) break;
    rows.push_back(r);
  }
  return rows;
}

grid_point read_box(const std::string& scene) {
  std::istringstream words(config::read_file(golden + scene + "/scene_aabb.txt"));
  grid_point box;
  for (std::int64_t& word : box) words >> std::hex >> word;
  return box;
}

row words_of(const accelerated_triangle& a) { return {a.pp, a.pq, a.d, a.e1p, a.e1q, a.e2p, a.e2q, a.np, a.nq, a.r}; }

void append_cube(mesh& m, const glm::dvec3& lower, const glm::dvec3& upper) {
  for (glm::length_t r = 0; r < 3; ++r)
    for (const bool at_upper : {false, true}) {
      const auto first = static_cast<std::uint32_t>(m.vertices.size());
      for (const auto& [p, q] : {std::pair{false, false}, {true, false}, {true, true}, {false, true}}) {
        glm::dvec3 v = lower;
        if (at_upper) v[r] = upper[r];
        if (p) v[(r + 1) % 3] = upper[(r + 1) % 3];
        if (q) v[(r + 2) % 3] = upper[(r + 2) % 3];
        m.vertices.push_back(v);
      }
      const std::uint32_t before = at_upper ? first + 3 : first + 1, behind = at_upper ? first + 1 : first + 3;
      m.triangles.push_back({first, before, first + 2});
      m.triangles.push_back({first, first + 2, behind});
    }
}

/// Whether a triangle's words come out with its near ties rounded one way or the other.
bool ties_explain(const row& wanted, const std::array<glm::dvec3, 3>& corners, const scene_grid& grid) {
  std::array<grid_point, 3> lower;
  std::vector<std::int64_t*> ties;
  for (unsigned i = 0; i < 3; ++i) {
    lower[i] = grid.nearest(corners[i]);
    for (unsigned k = 0; k < 3; ++k) {
      const auto axis = static_cast<glm::length_t>(k);
      const double at = (corners[i][axis] - grid.origin[axis]) * grid.units / grid.side;
      if (std::abs(at - std::floor(at) - 0.5) > 1e-5) continue;
      lower[i][k] = static_cast<std::int64_t>(std::floor(at));
      ties.push_back(&lower[i][k]);
    }
  }
  for (unsigned up = 0; up < 1U << ties.size(); ++up) {
    for (unsigned i = 0; i < ties.size(); ++i) *ties[i] += up >> i & 1;
    bool clamped = false;
    const auto a = accelerate(lower, {}, clamped);
    for (unsigned i = 0; i < ties.size(); ++i) *ties[i] -= up >> i & 1;
    if (a && words_of(*a) == wanted) return true;
  }
  return false;
}

std::string refusal_of(const mesh& m, const quantisation& q) {
  try {
    quantise(m, q, "the mesh");
  } catch (const input_error& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("quantised_triangles: the tetrahedron's words", "[scenes]") {
  mesh m;
  m.vertices = {{0, 0, 0}, {0.95, 0.05, 1}, {1, 0.9, 0.1}, {0.1, 1, 0.85}};
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}};
  const quantised_triangles t = quantise(m, {}, "tetra");
  const auto wanted = read_triangles("tetra_k1");
  REQUIRE(wanted.size() == 4);
  REQUIRE(t.triangles.size() == 4);
  CHECK(t.box == read_box("tetra_k1"));
  for (std::size_t i = 0; i < 4; ++i) CHECK(words_of(t.triangles[i]) == wanted[i]);
  CHECK(t.dropped == 0);
  CHECK(t.clamped == 0);
}

TEST_CASE("quantised_triangles: the words of teapot and cube, but for the vertices halfway between grid points", "[scenes]") {
  mesh m = tessellate(parse_bpt(config::read_file(RTUSIM_SOURCE_DIR "/scenes/data/teapot.bpt"), "teapot.bpt"), 3);
  append_cube(m, {2.2, 2.2, 0.8}, {3.2, 3.2, 1.8});
  const quantised_triangles t = quantise(m, {}, "cubepot");
  const auto wanted = read_triangles("cubepot_k8");
  REQUIRE(wanted.size() == 564);
  REQUIRE(t.triangles.size() == 564);
  CHECK(t.box == read_box("cubepot_k8"));
  CHECK(t.dropped == 24);
  CHECK(t.clamped == 0);
  unsigned same = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    CAPTURE(i);
    if (words_of(t.triangles[i]) == wanted[i]) {
      ++same;
      continue;
    }
    const auto& corners = m.triangles[t.source[i]];
    REQUIRE(ties_explain(wanted[i], {m.vertices[corners[0]], m.vertices[corners[1]], m.vertices[corners[2]]}, t.grid));
  }
  CHECK(same >= 250);
}

TEST_CASE("quantised_triangles: words of the widest grid against long doubles", "[scenes]") {
  const quantisation widest{32, 34, 20, 16, 0};
  test::rng random(5);
  const std::int64_t greatest = widest.greatest_coordinate();
  unsigned seen_clamped = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::array<grid_point, 3> corners;
    const unsigned spread = random() % 32;
    for (grid_point& c : corners)
      for (unsigned k = 0; k < 3; ++k) {
        const auto near = static_cast<std::int64_t>(random() >> spread);
        c[k] = random() % 8 == 0 ? (random() % 2 == 0 ? 0 : greatest) : std::min(greatest, (&c == &corners[0] ? 0 : corners[0][k]) + near);
      }
    bool clamped = false;
    const auto a = accelerate(corners, widest, clamped);
    if (!a) continue;
    seen_clamped += clamped;
    const unsigned r = a->r, p = (r + 1) % 3, q = (r + 2) % 3;
    const auto edge = [&](unsigned v, unsigned k) { return static_cast<long double>(corners[v][k] - corners[0][k]); };
    const auto component = [&](unsigned k) {
      return edge(1, (k + 1) % 3) * edge(2, (k + 2) % 3) - edge(1, (k + 2) % 3) * edge(2, (k + 1) % 3);
    };
    // Of small differences the products are exact.
    if (std::abs(component(r)) > 0x1p62L) continue;
    const auto near = [](std::int64_t word, long double exact, long double relative) {
      return std::abs(static_cast<long double>(word) - exact) <= 0.5L + std::abs(exact) * relative;
    };
    const long double nr = component(r);
    CAPTURE(i, r);
    REQUIRE(nr != 0);
    REQUIRE(near(a->np, std::min(component(p) / nr * 0x1p33L, 0x1p33L - 1), 1e-17L));
    REQUIRE(near(a->nq, std::min(component(q) / nr * 0x1p33L, 0x1p33L - 1), 1e-17L));
    const long double most = 0x1p33L - 1;
    const auto limited = [most](long double x) { return std::max(-most, std::min(most, x)); };
    REQUIRE(near(a->e1p, limited(edge(1, p) / nr * 0x1p53L), 1e-17L));
    REQUIRE(near(a->e1q, limited(edge(1, q) / nr * 0x1p53L), 1e-17L));
    REQUIRE(near(a->e2p, limited(edge(2, p) / nr * 0x1p53L), 1e-17L));
    REQUIRE(near(a->e2q, limited(edge(2, q) / nr * 0x1p53L), 1e-17L));
    long double d = 0;
    for (unsigned k = 0; k < 3; ++k) d += component(k) / nr * static_cast<long double>(corners[0][k]);
    REQUIRE(near(a->d, d, 1e-9L));
  }
  CHECK(seen_clamped > 100);
}

TEST_CASE("quantised_triangles: a tie is rounded away from zero, and the first of equal axes is taken", "[scenes]") {
  // Edges of 1/2 and 3/2 units, E = 0, m = 4: 1.0 is 8, so a normal component of 16 makes an edge of 1 one half.
  const quantisation q{5, 4, 0, 0, 0};
  bool clamped = false;
  const auto a = accelerate({grid_point{0, 0, 7}, grid_point{1, 0, 7}, grid_point{0, 16, 7}}, q, clamped);
  REQUIRE(a);
  CHECK(words_of(*a) == row{0, 0, 7, 1, 0, 0, 7, 0, 0, 2});
  CHECK(clamped);  // 16/16 is 8
  const auto mirrored = accelerate({grid_point{0, 0, 7}, grid_point{0, 16, 7}, grid_point{1, 0, 7}}, q, clamped);
  REQUIRE(mirrored);
  CHECK(words_of(*mirrored) == row{0, 0, 7, 0, -7, -1, 0, 0, 0, 2});
  const auto diagonal = accelerate({grid_point{9, 0, 0}, grid_point{0, 9, 0}, grid_point{0, 0, 9}}, q, clamped);
  REQUIRE(diagonal);
  CHECK(diagonal->r == 0);
  CHECK(diagonal->np == 7);  // 1.0, saturated
  CHECK(diagonal->d == 9);
  CHECK_FALSE(accelerate({grid_point{1, 1, 1}, grid_point{2, 2, 2}, grid_point{5, 5, 5}}, q, clamped));
}

TEST_CASE("quantised_triangles: triangles that the grid makes thin are dropped or clamped, and counted", "[scenes]") {
  mesh m;
  append_cube(m, {-1, -1, -1}, {1, 1, 1});
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.insert(m.vertices.end(), {{0, 0, 0}, {1e-12, 0, 0}, {0, 1e-12, 0}, {0, 0, 1e-4}, {1e-8, 0, 1e-4}});
  m.triangles.push_back({first, first + 1, first + 2});
  m.triangles.push_back({first, first + 3, first + 4});
  const quantised_triangles t = quantise(m, {}, "cube");
  CHECK(t.triangles.size() == 13);
  CHECK(t.source.back() == 13);
  CHECK(t.dropped == 1);
  CHECK(t.clamped == 1);
  CHECK(t.box == grid_point{0x3fffffff, 0x3fffffff, 0x3fffffff});
  CHECK(t.corners[0][0] == grid_point{0, 0, 0});
  CHECK(t.grid.nearest({0, 0, 0}) == grid_point{0x20000000, 0x20000000, 0x20000000});  // halfway, to the even one
}

TEST_CASE("quantised_triangles: a mesh that can't be put on a grid is refused", "[scenes]") {
  mesh none;
  CHECK(refusal_of(none, {}) == "the mesh: no triangles; expected a mesh of triangles");
  mesh flat;
  flat.vertices = {{0, 3, 0}, {1, 3, 0}, {0, 3, 1}};
  flat.triangles = {{0, 1, 2}};
  CHECK(refusal_of(flat, {}) == "the mesh: a flat mesh: no extent along y on a grid of 2^30; expected a box with a volume");
  flat.vertices[1].y = 3 + 1e-12;
  CHECK_THAT(refusal_of(flat, {}), Catch::Contains("no extent along y"));
  mesh point;
  point.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  point.triangles = {{0, 1, 2}};
  CHECK_THAT(refusal_of(point, {}), Catch::Contains("no extent along x"));
  mesh line;
  line.vertices = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  line.triangles = {{0, 1, 2}};
  CHECK(refusal_of(line, {}) == "the mesh: no triangle has an area on a grid of 2^30; expected a mesh of triangles");
}

}  // namespace rtusim
