#include "testbench/kinds/triangle_model.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "testbench/tests/scratch.h"

// What results of triangle cores show in the world, by hand. The grid has 4095 units for the mesh's longest side, which is 4 long.
namespace rtusim {
namespace {

/// Two ends of a box of 4 x 2 x 1 and a sloping triangle. Its first face has no area, its third one none on the grid.
const char* const mesh_text =
    "v 0 0 0\nv 0 2 0\nv 0 0 1\nv 0 2 1\nv 4 0 0\nv 4 2 0\nv 4 0 1\nv 4 2 1\nv 1 1 .5\nv 1.0001 1 .5\nv 1 1.0001 .5\n"
    "f 1 2 2\n"
    "f 1 3 4 2\n"  // to the left, as the right hand has it
    "f 9 10 11\n"
    "f 5 6 8 7\n"                                        // to the right
    "f 1 5 4\n";                                         // down and forward
constexpr std::uint32_t left = 0, right = 2, slope = 4;  // triangles

quantisation grid_of_12_bits() {
  quantisation q;
  q.n = 12;
  q.edge_shift = 0;
  return q;
}

struct box_model : test::scratch_folder {
  quantisation q = grid_of_12_bits();
  triangle_model model = load_triangles(file("box.obj", mesh_text), q, 8, 10, 1);
};

using vec = std::array<double, 3>;

std::uint32_t bits(double value) {
  const auto narrow = static_cast<float>(value);
  std::uint32_t word;
  std::memcpy(&word, &narrow, sizeof word);
  return word;
}

job_packet ray(const vec& origin_units, const vec& direction) {
  job_packet j;
  for (std::size_t i = 0; i < 3; ++i) {
    j.t0[i] = bits(origin_units[i] / 4096);
    j.t1[i] = bits(direction[i]);
  }
  return j;
}

mesh_result met(std::uint32_t triangle, std::int64_t t) {
  mesh_result r;
  r.hit = true;
  r.triangle = triangle;
  r.t_hit = t;
  return r;
}

constexpr double units_a_world_unit = 4095 / (2 * 0.98);

}  // namespace

TEST_CASE("triangle surfaces: where a mesh stands on the grid, and which face each of its triangles is", "[surfaces]") {
  const box_model m;
  CHECK(m.model.grid.n == 12);
  CHECK(m.model.grid.scale == Approx(units_a_world_unit));
  CHECK(m.model.grid.centre[0] == Approx(4095 / 2.0));
  CHECK(m.model.grid.centre[1] == Approx(4095 / 4.0));
  CHECK(m.model.grid.centre[2] == Approx(4095 / 8.0));
  CHECK(m.model.grid.corner == per_axis<double>{4095, 2048, 1024});
  CHECK(m.model.hierarchy.corner == per_axis<std::int64_t>{4095, 2048, 1024});
  CHECK(m.model.faces == std::vector<std::uint32_t>{1, 1, 3, 3, 4});
  CHECK(m.model.losses.dropped == 1);
  CHECK(m.model.losses.clamped == 0);
  REQUIRE(m.model.normals.size() == 5);
  for (const std::uint32_t i : {0u, 1u}) CHECK(m.model.normals[i] == std::array<float, 3>{-1, 0, 0});
  for (const std::uint32_t i : {2u, 3u}) CHECK(m.model.normals[i] == std::array<float, 3>{1, 0, 0});
  CHECK(m.model.normals[slope][0] == 0);
  CHECK(m.model.normals[slope][1] == Approx(-1 / std::sqrt(5.0)));
  CHECK(m.model.normals[slope][2] == Approx(2 / std::sqrt(5.0)));
}

TEST_CASE("triangle surfaces: distance from the ray's origin, a normal that is turned to it, the mesh's face", "[surfaces]") {
  const box_model m;
  const double down = 1 / std::sqrt(5.0), forward = 2 / std::sqrt(5.0);
  const double third = 1 / std::sqrt(3.0);
  const struct {
    vec origin, direction;
    std::uint32_t triangle;
    std::int64_t t;  // from where the ray enters the box
    double distance_units;
    vec normal;
    std::uint32_t face;
  } rays[] = {
      // Along x from outside, through both ends, each way; and from inside.
      {{-2000, 1000, 500}, {1, 0, 0}, left, 0, 2000, {-1, 0, 0}, 1},
      {{-2000, 1000, 500}, {1, 0, 0}, left + 1, 0, 2000, {-1, 0, 0}, 1},
      {{-2000, 1000, 500}, {1, 0, 0}, right, 4095, 6095, {-1, 0, 0}, 3},
      {{6000, 1000, 500}, {-1, 0, 0}, right, 0, 1905, {1, 0, 0}, 3},
      {{6000, 1000, 500}, {-1, 0, 0}, right + 1, 0, 1905, {1, 0, 0}, 3},
      {{6000, 1000, 500}, {-1, 0, 0}, left + 1, 4095, 6000, {1, 0, 0}, 1},
      {{2000, 1000, 500}, {-1, 0, 0}, left, 2000, 2000, {1, 0, 0}, 1},
      {{2000, 1000, 500}, {1, 0, 0}, right, 2095, 2095, {-1, 0, 0}, 3},
      // The slope from above, below, behind, in front, and along it.
      {{500, 3000, 100}, {0, -1, 0}, slope, 1848, 2800, {0, down, -forward}, 4},
      {{500, -300, 100}, {0, 1, 0}, slope, 200, 500, {0, -down, forward}, 4},
      {{500, 200, -400}, {0, 0, 1}, slope, 100, 500, {0, down, -forward}, 4},
      {{500, 200, 1524}, {0, 0, -1}, slope, 924, 1424, {0, -down, forward}, 4},
      {{500, 200, 100}, {1, 0, 0}, slope, 77, 77, {0, -down, forward}, 4},
      // Aslant from outside: it enters through the left end, 1000 / 0.6 from its origin.
      {{-1000, -1000, 500}, {0.6, 0.8, 0}, left, 0, 1000 / 0.6, {-1, 0, 0}, 1},
      {{-1000, -1000, 500}, {0.6, 0.8, 0}, left, 300, 1000 / 0.6 + 300, {-1, 0, 0}, 1},
      {{-1000, 3048, 1524}, {third, -third, -third}, right, 700, 1000 / third + 700, {-1, 0, 0}, 3},
      // Directions whose components add up to 1: a unit of t is shorter.
      {{2000, 500, 500}, {0.5, 0.5, 0}, right, 100, 100 * std::sqrt(0.5), {-1, 0, 0}, 3},
      {{2000, 500, 500}, {-0.25, 0.25, 0.5}, left, 1000, 1000 * std::sqrt(0.375), {1, 0, 0}, 1},
  };
  for (const auto& r : rays) {
    CAPTURE(r.origin, r.direction, r.triangle, r.t);
    const frame::surface s = triangle_surfaces(m.model, m.q, 1).at(ray(r.origin, r.direction), met(r.triangle, r.t));
    CHECK(s.distance * units_a_world_unit == Approx(r.distance_units).margin(2));  // entries lie on the grid
    CHECK(s.triangle == r.face);
    for (std::size_t i = 0; i < 3; ++i) CHECK(s.normal[i] == Approx(r.normal[i]).margin(1e-6));
  }
}

TEST_CASE("triangle surfaces: a result's last bit may be worth two units, and a miss shows nothing", "[surfaces]") {
  const box_model m;
  const triangle_surfaces halved(m.model, m.q, 2);
  const job_packet from_outside = ray({-2000, 1000, 500}, {1, 0, 0});
  CHECK(halved.at(from_outside, met(right, 1000)).distance * units_a_world_unit == Approx(4000).margin(2));
  CHECK(triangle_surfaces(m.model, m.q, 1).at(from_outside, met(right, 1000)).distance * units_a_world_unit == Approx(3000).margin(2));
  mesh_result missed = met(slope, 1000);
  missed.hit = false;
  const frame::surface none = halved.at(from_outside, missed);
  CHECK(none.distance == 0);
  CHECK(none.normal == std::array<float, 3>{0, 0, 0});
  CHECK(none.triangle == 0);
}

}  // namespace rtusim
