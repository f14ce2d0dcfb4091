#include "scenes/voxeliser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/common.hpp>

#include "modules/config/error.h"
#include "scenes/mesh.h"
#include "scenes/voxel_grid.h"

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

mesh joined(mesh a, const mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
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
    expected |= voxelise_surface(m, 64, 1.0);
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
  // Inside out it is the same; another cube inside is a hole.
  mesh turned = cube_of({0, 0, 0}, 1);
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  CHECK(voxelise_solid(turned, 16, "cube").count() == 16 * 16 * 16);
  const mesh hollow = joined(cube_of({0, 0, 0}, 16), cube_of({4.25, 4.25, 4.25}, 7.5));
  CHECK(voxelise_solid(hollow, 16, "cube", 1.0).count() == 16 * 16 * 16 - 6 * 6 * 6);
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
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges"));
  m = cube_of({0, 0, 0}, 1);
  m.triangles.push_back({0, 1, 7});  // a wall inside
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges"));
  m = cube_of({0, 0, 0}, 1);
  m.triangles.push_back(m.triangles.front());  // a face twice
  CHECK_THAT(leak_of(m), Catch::StartsWith("cube: 3 open edges"));
}

TEST_CASE("parity along an axis", "[voxel_grid]") {
  std::mt19937 random(3);
  for (const unsigned resolution : {2U, 4U, 8U, 16U})
    for (unsigned axis = 0; axis < 3; ++axis) {
      voxel_grid grid(resolution);
      for (unsigned n = 0; n < resolution * resolution; ++n)
        grid.flip(static_cast<unsigned>(random() % resolution), static_cast<unsigned>(random() % resolution),
                  static_cast<unsigned>(random() % resolution));
      voxel_grid expected(resolution);
      for (unsigned u = 0; u < resolution; ++u)
        for (unsigned v = 0; v < resolution; ++v) {
          bool odd = false;
          for (unsigned w = 0; w < resolution; ++w) {
            std::array<unsigned, 3> at{};
            at[axis] = w, at[(axis + 1) % 3] = u, at[(axis + 2) % 3] = v;
            odd ^= grid.at(at[0], at[1], at[2]);
            if (odd) expected.fill(at[0], at[1], at[2]);
          }
        }
      grid.accumulate_parity(axis);
      CAPTURE(resolution, axis);
      CHECK((grid == expected));
    }
}

}  // namespace rtusim
