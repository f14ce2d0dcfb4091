#include "scenes/voxeliser.h"

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/common.hpp>

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

}  // namespace rtusim
