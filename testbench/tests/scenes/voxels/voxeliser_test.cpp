#include "scenes/voxels/voxeliser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "modules/config/error.h"
#include "scenes/meshes/mesh.h"
#include "scenes/meshes/orientation.h"
#include "scenes/voxels/voxel_grid.h"

namespace rtusim {
namespace {

const std::string data = RTUSIM_SOURCE_DIR "/scenes/data/";

// The mesh plus two far corners, whose triangles are as small as a point: a box of [-1,1]^3 that nothing moves.
mesh in_fixed_frame(mesh m) {
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  m.vertices.emplace_back(-1.0);
  m.vertices.emplace_back(1.0);
  m.triangles.push_back({first, first, first});
  m.triangles.push_back({first + 1, first + 1, first + 1});
  return m;
}

constexpr int steps_a_voxel = 1024;

// The mesh as it stands at 64 voxels an edge, its vertices on the nearest 1024th of a voxel, and the two far corners: then the voxeliser
// computes without rounding at `fit` 1.
mesh on_dyadic_steps(mesh m) {
  const bounding_box box = bounds(m);
  constexpr double half_steps = 32 * steps_a_voxel;
  for (glm::dvec3& v : m.vertices)
    v = glm::round(((v - box.centre()) * (default_fit / box.half_extent()) + 1.0) * half_steps) / half_steps - 1.0;
  return in_fixed_frame(m);
}

using exact_point = std::array<std::int64_t, 3>;

// In half steps from the root cube's lower corner, so that a voxel's centre is a whole number.
exact_point exact(const glm::dvec3& v) {
  exact_point p{};
  for (int k = 0; k < 3; ++k) p[static_cast<std::size_t>(k)] = std::llround((v[k] + 1) * 32 * steps_a_voxel * 2);
  return p;
}

exact_point minus(const exact_point& a, const exact_point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
std::int64_t dot(const exact_point& a, const exact_point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
exact_point cross(const exact_point& a, const exact_point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Whether a triangle and a voxel have a point in common: two convex bodies have none if their shadows on one of 13 axes have none (the
// faces' normals and the products of their edges). The shadows are those of all corners, in whole numbers.
bool have_common_point(const std::array<exact_point, 3>& t, const std::array<int, 3>& voxel) {
  std::array<exact_point, 8> corners{};
  for (std::size_t c = 0; c < 8; ++c)
    for (std::size_t k = 0; k < 3; ++k) corners[c][k] = (voxel[k] + static_cast<int>((c >> k) & 1)) * 2 * steps_a_voxel;
  const std::array<exact_point, 3> units{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::vector<exact_point> axes(units.begin(), units.end());
  axes.push_back(cross(minus(t[1], t[0]), minus(t[2], t[0])));
  for (std::size_t k = 0; k < 3; ++k)
    for (const exact_point& u : units) axes.push_back(cross(minus(t[(k + 1) % 3], t[k]), u));
  return std::none_of(axes.begin(), axes.end(), [&](const exact_point& axis) {
    const auto shadow = [&](const auto& points) {
      std::array<std::int64_t, 2> s{dot(axis, points[0]), dot(axis, points[0])};
      for (const exact_point& p : points) s = {std::min(s[0], dot(axis, p)), std::max(s[1], dot(axis, p))};
      return s;
    };
    const auto a = shadow(t), b = shadow(corners);
    return a[1] < b[0] || b[1] < a[0];
  });
}

// The voxels that have a point in common with a triangle, at 64 an edge.
voxel_grid touched_exactly(const mesh& m) {
  voxel_grid grid(64);
  for (const auto& corners : m.triangles) {
    std::array<exact_point, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = exact(m.vertices[corners[k]]);
    std::array<int, 3> first{}, last{};  // beyond them the shadows on the axes x, y and z are apart
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [least, most] = std::minmax({t[0][k], t[1][k], t[2][k]});
      first[k] = static_cast<int>(std::max<std::int64_t>(least / (2 * steps_a_voxel) - 1, 0));
      last[k] = static_cast<int>(std::min<std::int64_t>(most / (2 * steps_a_voxel) + 1, 63));
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x)
          if (have_common_point(t, {x, y, z})) grid.fill(static_cast<unsigned>(x), static_cast<unsigned>(y), static_cast<unsigned>(z));
  }
  return grid;
}

// The voxels from which a ray along x crosses the mesh an odd number of times, at 64 an edge. The rays pass a little beside the centres,
// so that they meet no edge; where no surface touches the voxel, that comes to the same.
voxel_grid inside_along_x(const mesh& m) {
  constexpr unsigned edge = 64;
  constexpr double beside_y = 0.0123456, beside_z = -0.0345678;
  voxel_grid grid(edge);
  for (unsigned z = 0; z < edge; ++z)
    for (unsigned y = 0; y < edge; ++y) {
      const double py = (y + 0.5 + beside_y) / 32 - 1, pz = (z + 0.5 + beside_z) / 32 - 1;
      std::array<unsigned, edge + 1> crossings{};  // by how many voxels have their centre before them
      for (const auto& t : m.triangles) {
        const glm::dvec3 &a = m.vertices[t[0]], &b = m.vertices[t[1]], &c = m.vertices[t[2]];
        if (pz < std::min({a.z, b.z, c.z}) || pz > std::max({a.z, b.z, c.z})) continue;
        // Twice the areas of the triangles that the point forms with the edges, in the plane of y and z.
        const auto area = [&](const glm::dvec3& p, const glm::dvec3& q) { return (p.y - py) * (q.z - pz) - (p.z - pz) * (q.y - py); };
        const double of_a = area(b, c), of_b = area(c, a), of_c = area(a, b), all = of_a + of_b + of_c;
        if (all == 0 || !((of_a > 0) == (of_b > 0) && (of_b > 0) == (of_c > 0))) continue;
        const double x = (of_a * a.x + of_b * b.x + of_c * c.x) / all;
        ++crossings[static_cast<std::size_t>(std::clamp(std::ceil((x + 1) * 32 - 0.5), 0.0, double{edge}))];
      }
      unsigned sum = 0;
      for (unsigned x = 0; x < edge; ++x) {
        sum += crossings[x];
        if (sum % 2 != 0) grid.fill(x, y, z);
      }
    }
  return grid;
}

mesh cube_of(const glm::dvec3& lower, double edge) {
  mesh m;
  for (int i = 0; i < 8; ++i) m.vertices.push_back(lower + edge * glm::dvec3(i & 1, (i >> 1) & 1, i >> 2));
  for (const auto& q : {std::array<std::uint32_t, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    m.triangles.push_back({q[0], q[1], q[2]});
    m.triangles.push_back({q[0], q[2], q[3]});
  }
  return m;
}

void turn_inside_out(mesh& m) {
  for (auto& t : m.triangles) std::swap(t[1], t[2]);
}

mesh joined(mesh a, const mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

// How often a mesh winds around a point: the solid angles under which its triangles are seen (van Oosterom and Strackee 1983), by 4 pi.
double winding_number(const mesh& m, const glm::dvec3& point) {
  double sum = 0;
  for (const auto& t : m.triangles) {
    const glm::dvec3 a = m.vertices[t[0]] - point, b = m.vertices[t[1]] - point, c = m.vertices[t[2]] - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += 2 * std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (4 * 3.141592653589793);
}

// Of each voxel that no surface touches: filled if and only if the mesh winds around its centre.
void check_winding(const mesh& m, unsigned resolution) {
  const double fit = 0.9;
  const voxel_grid touched = voxelise_surface(m, resolution, fit), solid = voxelise_solid(m, resolution, "mesh", fit);
  const bounding_box box = bounds(m);
  unsigned inside = 0, wrong = 0;
  for (unsigned z = 0; z < resolution; ++z)
    for (unsigned y = 0; y < resolution; ++y)
      for (unsigned x = 0; x < resolution; ++x) {
        if (touched.at(x, y, z)) {
          wrong += solid.at(x, y, z) ? 0 : 1;
          continue;
        }
        const glm::dvec3 place = (glm::dvec3(x, y, z) + 0.5) * (2.0 / resolution) - 1.0;
        const double winding = winding_number(m, place * (box.half_extent() / fit) + box.centre());
        REQUIRE(std::abs(winding - std::round(winding)) < 1e-6);
        const bool expected = std::round(winding) != 0;
        inside += expected ? 1 : 0;
        wrong += expected != solid.at(x, y, z) ? 1 : 0;
      }
  CHECK(inside > 0);
  CHECK(wrong == 0);
}

// A ball of triangles, an octahedron divided `times`, somewhere and stretched.
mesh ball(std::mt19937& random, int times, double least, double most) {
  mesh m;
  m.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int n = 0; n < times; ++n) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.emplace(std::array{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(m.vertices.size()));
      if (is_new) m.vertices.push_back(glm::normalize(m.vertices[a] + m.vertices[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& t : m.triangles) {
      const std::uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      for (const auto& part : {std::array{t[0], ab, ca}, std::array{ab, t[1], bc}, std::array{ca, bc, t[2]}, std::array{ab, bc, ca}})
        finer.push_back(part);
    }
    m.triangles = finer;
  }
  std::uniform_real_distribution<double> size(least, most), place(-1, 1);
  const glm::dvec3 radii(size(random), size(random), size(random)), centre(place(random), place(random), place(random));
  for (glm::dvec3& v : m.vertices) v = v * radii + centre;
  return m;
}

// The message with which a mesh is not filled.
std::string leak_of(const mesh& m) {
  try {
    voxelise_solid(m, 16, "cube");
  } catch (const input_error& e) {
    return e.what();
  }
  return "filled";
}

}  // namespace

TEST_CASE("a voxel grid keeps its bits in Morton order", "[voxel_grid]") {
  voxel_grid grid(8);
  CHECK(grid.levels() == 3);
  CHECK(grid.count() == 0);
  grid.fill(1, 0, 0);
  grid.fill(0, 2, 0);
  grid.fill(7, 7, 7);
  CHECK(grid.at(1, 0, 0));
  CHECK(grid.at(0, 2, 0));
  CHECK(grid.at(7, 7, 7));
  CHECK_FALSE(grid.at(0, 0, 0));
  CHECK(grid.count() == 3);
  CHECK(grid.blocks().front() == ((std::uint64_t{1} << 1) | (std::uint64_t{1} << 16)));
  CHECK(grid.blocks().back() == std::uint64_t{1} << 63);

  voxel_grid cubes(8);
  cubes.fill_cube(2, 1);  // x from 4 to 7, y and z from 0 to 3
  cubes.fill_cube(1, 2);  // y from 2 to 3, x and z from 0 to 1
  cubes.fill_cube(0, 0);
  CHECK(cubes.count() == 64 + 8 + 1);
  CHECK(cubes.at(4, 3, 3));
  CHECK(cubes.at(1, 3, 1));
  CHECK(cubes.at(0, 0, 0));
  CHECK_FALSE(cubes.at(1, 0, 0));
  cubes.fill_cube(3, 0);
  CHECK(cubes.count() == 512);

  CHECK(voxel_grid(1024).blocks().size() == (std::size_t{1} << 24));
  for (const unsigned r : {2U, 4U, 1024U}) CHECK(voxel_grid::is_resolution(r));
  for (const unsigned r : {0U, 1U, 3U, 48U, 2048U}) CHECK_FALSE(voxel_grid::is_resolution(r));
}

TEST_CASE("a cube's surface is a hollow shell of voxels", "[voxeliser]") {
  mesh cube;
  for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(100 + 3 * (i & 1), 3 * ((i >> 1) & 1), -3 * (i >> 2));
  for (const auto& q : {std::array<std::uint32_t, 4>{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    cube.triangles.push_back({q[0], q[1], q[2]});
    cube.triangles.push_back({q[0], q[2], q[3]});
  }
  CHECK(voxelise_surface(cube, 16).count() == 16 * 16 * 16 - 14 * 14 * 14);
  // Half as large: its faces lie on voxel borders, and both neighbours count.
  CHECK(voxelise_surface(cube, 16, 0.5).count() == 10 * 10 * 10 - 6 * 6 * 6);
  CHECK(voxelise_surface(cube, 2).count() == 8);
}

TEST_CASE("voxels are those that the triangles touch", "[voxeliser]") {
  std::mt19937 random(7);
  const unsigned resolution = 32;
  for (int n = 0; n < 60; ++n) {
    const double size = n % 3 == 0 ? 0.9 : n % 3 == 1 ? 0.2 : 0.03;
    std::uniform_real_distribution<double> anywhere(-1.0 + size, 1.0 - size), near(-size, size);
    const glm::dvec3 centre(anywhere(random), anywhere(random), anywhere(random));
    mesh m;
    for (int k = 0; k < 3; ++k) m.vertices.push_back(centre + glm::dvec3(near(random), near(random), near(random)));
    m.triangles.push_back({0, 1, 2});
    const voxel_grid grid = voxelise_surface(in_fixed_frame(m), resolution, 1.0);

    // Every point of the triangle lies in a filled voxel.
    std::uniform_real_distribution<double> share(0, 1);
    for (int i = 0; i < 2000; ++i) {
      double u = share(random), v = share(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const glm::dvec3 p = m.vertices[0] + u * (m.vertices[1] - m.vertices[0]) + v * (m.vertices[2] - m.vertices[0]);
      const glm::uvec3 voxel(glm::floor((p + 1.0) * (0.5 * resolution)));
      REQUIRE(grid.at(voxel.x, voxel.y, voxel.z));
    }
    // Every filled voxel holds a point of the triangle: alternating projections onto the two convex sets close in on it.
    for (unsigned z = 0; z < resolution; ++z)
      for (unsigned y = 0; y < resolution; ++y)
        for (unsigned x = 0; x < resolution; ++x) {
          const bool corner = x + y + z == 0 || x + y + z == 3 * (resolution - 1);  // the fixed frame
          if (!grid.at(x, y, z) || corner) continue;
          const glm::dvec3 lower = glm::dvec3(x, y, z) * (2.0 / resolution) - 1.0, upper = lower + 2.0 / resolution;
          // The triangle clipped by the six planes of the box, grown by rounding, is not empty.
          std::vector<glm::dvec3> polygon = m.vertices;
          for (int k = 0; k < 3; ++k)
            for (const double side : {-1.0, 1.0}) {
              const double border = (side < 0 ? -lower[k] : upper[k]) + 1e-9;
              std::vector<glm::dvec3> kept;
              for (std::size_t i = 0; i < polygon.size(); ++i) {
                const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
                const double da = side * a[k] - border, db = side * b[k] - border;
                if (da <= 0) kept.push_back(a);
                if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
              }
              polygon = kept;
            }
          CAPTURE(n, x, y, z);
          REQUIRE_FALSE(polygon.empty());
        }
  }
}

TEST_CASE("a model stands centred in the root cube", "[voxeliser]") {
  const mesh dragon = read_mesh(data + "dragon_res4.ply");
  const voxel_grid grid = voxelise_surface(dragon, 64);
  glm::uvec3 least(64), most(0);
  for (unsigned z = 0; z < 64; ++z)
    for (unsigned y = 0; y < 64; ++y)
      for (unsigned x = 0; x < 64; ++x)
        if (grid.at(x, y, z)) {
          least = glm::min(least, glm::uvec3(x, y, z));
          most = glm::max(most, glm::uvec3(x, y, z));
        }
  CHECK(least.x == 0);
  CHECK(most.x == 63);
  CHECK(least.y + most.y == 63);
  CHECK(least.z + most.z == 63);
  // Figures of this voxeliser, so that a change of its convention shows.
  CHECK(voxelise_surface(dragon, 32).count() == 2316);
  CHECK(voxelise_surface(read_mesh(data + "dragon_res3.ply.gz"), 128).count() == 39406);
}

TEST_CASE("the voxels of three meshes are those of an exact test", "[voxeliser]") {
  for (const char* name : {"dragon_res4.ply", "bunny.obj", "teapot.bpt"}) {
    CAPTURE(name);
    const mesh m = on_dyadic_steps(read_mesh(data + name));
    const voxel_grid expected = touched_exactly(m);
    CHECK(expected.count() > 5000);
    CHECK((voxelise_surface(m, 64, 1.0) == expected));
  }
}

TEST_CASE("solid is surface and inside, as seen along another axis", "[voxeliser]") {
  for (const char* name : {"dragon_res4.ply", "bunny.obj"}) {
    CAPTURE(name);
    const mesh m = on_dyadic_steps(read_mesh(data + name));
    voxel_grid expected = inside_along_x(m);
    const voxel_grid touched = voxelise_surface(m, 64, 1.0);
    for (std::uint32_t i = 0; i < touched.blocks().size(); ++i) expected.fill_block(i, touched.blocks()[i]);
    const voxel_grid solid = voxelise_solid(m, 64, name, 1.0);
    CHECK(solid.count() > voxelise_surface(m, 64, 1.0).count());
    CHECK((solid == expected));
  }
}

TEST_CASE("a solid cube is filled, wherever its corners lie", "[voxeliser]") {
  for (const unsigned resolution : {2U, 4U, 8U, 32U}) {
    CAPTURE(resolution);
    CHECK(voxelise_solid(cube_of({-7, 3, 1}, 5), resolution, "cube").count() == resolution * resolution * resolution);
  }
  // Corners, edges and diagonals at the centres of voxels, and at their borders.
  CHECK(voxelise_solid(cube_of({0, 0, 0}, 1), 16, "cube", 11.0 / 16).count() == 12 * 12 * 12);
  CHECK(voxelise_solid(cube_of({0, 0, 0}, 1), 16, "cube", 0.5).count() == 10 * 10 * 10);
  // Inside out it is the same; another cube inside is nothing more, and a hollow if it is turned inside out.
  mesh turned = cube_of({0, 0, 0}, 1);
  turn_inside_out(turned);
  CHECK(voxelise_solid(turned, 16, "cube").count() == 16 * 16 * 16);
  mesh inner = cube_of({4.25, 4.25, 4.25}, 7.5);
  CHECK(voxelise_solid(joined(cube_of({0, 0, 0}, 16), inner), 16, "cube", 1.0).count() == 16 * 16 * 16);
  turn_inside_out(inner);
  CHECK(voxelise_solid(joined(cube_of({0, 0, 0}, 16), inner), 16, "cube", 1.0).count() == 16 * 16 * 16 - 6 * 6 * 6);
  // Two cubes with an edge in common: four triangles at it, two each way.
  const mesh twins = joined(cube_of({0, 0, 0}, 1), cube_of({1, 1, 0}, 1));
  CHECK(voxelise_solid(twins, 16, "cube", 1.0).count() > 2 * 8 * 8 * 8);
}

TEST_CASE("a mesh that leaks is not filled", "[voxeliser]") {
  mesh m = cube_of({0, 0, 0}, 1);
  CHECK(find_open_edges(m).count == 0);
  CHECK(leak_of(m) == "filled");
  m.triangles.pop_back();
  CHECK(find_open_edges(m).count == 3);
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges, the first from (1, 0, 1) to (1, 1, 1); expected a closed mesh"));
  m = cube_of({0, 0, 0}, 1);
  std::swap(m.triangles[5][0], m.triangles[5][1]);  // turned against its neighbours
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 edges whose faces run the same way, the first from"));
  m = cube_of({0, 0, 0}, 1);
  m.triangles.push_back({0, 1, 7});  // a wall inside
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges"));
  m = cube_of({0, 0, 0}, 1);
  m.triangles.push_back(m.triangles.front());  // a face twice
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges"));
}

TEST_CASE("solid is where the winding number is not 0, over bodies that overlap, nest and are turned", "[voxeliser]") {
  std::mt19937 random(11);
  for (int n = 0; n < 12; ++n) {
    CAPTURE(n);
    mesh all;
    for (int body = 0; body < 2 + n % 4; ++body) {
      mesh b = ball(random, n % 3, 0.2, 1.2);
      if (random() % 3 == 0) turn_inside_out(b);
      all = joined(all, b);
    }
    check_winding(all, n % 2 == 0 ? 16 : 32);
  }
  // A body within one within one, all faces outwards, the inner ones turned, and one of the inner ones.
  for (unsigned turned = 0; turned < 8; ++turned) {
    CAPTURE(turned);
    mesh all;
    for (unsigned k = 0; k < 3; ++k) {
      mesh b = cube_of(glm::dvec3(k * 1.5), 10.0 - 3 * k);
      if (((turned >> k) & 1) != 0) turn_inside_out(b);
      all = joined(all, b);
    }
    check_winding(all, 16);
  }
  // A surface that passes through itself: a ring that runs around twice, so that most of it is wound around twice.
  mesh ring;
  constexpr unsigned along = 60, around = 12;
  for (unsigned i = 0; i < along; ++i)
    for (unsigned j = 0; j < around; ++j) {
      const double u = 4 * 3.141592653589793 * i / along, v = 2 * 3.141592653589793 * j / around;
      const double from_axis = 2 + 0.3 * std::cos(u / 2) + 0.8 * std::cos(v);
      ring.vertices.emplace_back(from_axis * std::cos(u), from_axis * std::sin(u), 0.8 * std::sin(v) + 0.3 * std::sin(u / 2));
    }
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const auto at = [](std::uint32_t x, std::uint32_t y) { return x % along * around + y % around; };
      ring.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      ring.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  check_winding(ring, 32);
}

TEST_CASE("two cubes that overlap are one solid", "[voxeliser]") {
  const mesh m = read_mesh(RTUSIM_SOURCE_DIR "/testbench/tests/cases/mesh_cubes_overlapping.obj");
  CHECK(voxelise_solid(m, 32, "cubes", 1.0).count() == 17522);
}

TEST_CASE("faces that are turned against their neighbours are turned back", "[orientation]") {
  mesh m = read_mesh(RTUSIM_SOURCE_DIR "/testbench/tests/cases/mesh_cube_one_turned.obj");
  CHECK(turn_alike(m) == 2);
  CHECK(voxelise_solid(m, 16, "cube", 1.0).count() == 16 * 16 * 16);
  CHECK(turn_alike(m) == 0);

  // Random faces of a ball, fewer than half of them: all come back.
  std::mt19937 random(5);
  for (int n = 0; n < 20; ++n) {
    CAPTURE(n);
    const mesh whole = ball(random, 2, 0.5, 1);
    mesh turned = whole;
    std::uint64_t count = 0;
    for (auto& t : turned.triangles)
      if (random() % 10 < 4 && 2 * (count + 1) < turned.triangles.size()) std::swap(t[1], t[2]), ++count;
    CHECK(turn_alike(turned) == count);
    REQUIRE(turned.triangles.size() == whole.triangles.size());
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) {  // the same way around, from any corner
      auto t = turned.triangles[i];
      while (t[0] != whole.triangles[i][0]) std::rotate(t.begin(), t.begin() + 1, t.end());
      REQUIRE(t == whole.triangles[i]);
    }
  }
  // A hollow stays one, though a face of it and one of the body's are turned.
  mesh inner = cube_of(glm::dvec3(4.25), 7.5);
  turn_inside_out(inner);
  mesh hollow = joined(cube_of(glm::dvec3(0), 16), inner);
  CHECK(turn_alike(hollow) == 0);
  for (const std::size_t n : {3U, 15U}) std::swap(hollow.triangles[n][0], hollow.triangles[n][1]);
  CHECK(turn_alike(hollow) == 2);
  CHECK(voxelise_solid(hollow, 16, "cube", 1.0).count() == 16 * 16 * 16 - 6 * 6 * 6);
  // As many one way as the other: outwards.
  mesh even = cube_of(glm::dvec3(100), 1);
  for (std::size_t n = 0; n < 6; ++n) std::swap(even.triangles[n][0], even.triangles[n][1]);
  CHECK(turn_alike(even) == 6);
  CHECK(winding_number(even, glm::dvec3(100.5)) == Approx(1));
  // Bodies that share an edge keep each its own sides.
  mesh twin = cube_of({1, 1, 0}, 1);
  turn_inside_out(twin);
  mesh twins = joined(cube_of({0, 0, 0}, 1), twin);
  CHECK(turn_alike(twins) == 0);
  // One side alone: a Moebius strip stays as open as it was.
  mesh strip;
  for (std::uint32_t i = 0; i < 5; ++i) {
    strip.vertices.emplace_back(std::cos(1.3 * i), std::sin(1.3 * i), 0.1 * i);
    strip.triangles.push_back({i, (i + 1) % 5, (i + 2) % 5});
  }
  turn_alike(strip);
  CHECK_THAT(leak_of(strip), Catch::Contains("open edges"));
}

}  // namespace rtusim
