#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "modules/triangle_unit/triangle_intersector.h"
#include "scenes/triangles/quantised_triangles.h"
#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"

namespace rtusim {
namespace {

/// How many pairs were told early.
struct counts {
  std::uint64_t pairs = 0, hits = 0, early = 0;
};

/// Whether `hit_only` tells of this pair what the registers do.
bool agrees(const triangle_intersector& intersect, const triangle_request& q, counts& c) {
  const triangle_outcome all = intersect(q.position, q.direction, q.triangle);
  const triangle_outcome told = intersect.hit_only(q.position, q.direction, q.triangle);
  ++c.pairs;
  c.hits += all.hit;
  c.early += !told.hit && (told.u != all.u || told.v != all.v || told.t != all.t);
  if (told.hit != all.hit || told.err != all.err || told.wrapped != all.wrapped) return false;
  return !all.hit || (told.u == all.u && told.v == all.v && told.t == all.t);
}

std::int64_t coordinate(test::rng& random, std::int64_t greatest) {
  return static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) & static_cast<std::uint64_t>(greatest));
}

/// A triangle and a ray at a place on its border, at a corner, or a few grid units beside them.
bool grazing_pair(test::rng& random, const quantisation& q, triangle_request& request) {
  const std::int64_t greatest = q.greatest_coordinate();
  std::array<grid_point, 3> corners;
  const unsigned spread = random() % q.n;
  for (grid_point& c : corners)
    for (unsigned k = 0; k < 3; ++k)
      c[k] = std::min(greatest, (&c == &corners[0] ? 0 : corners[0][k]) + (coordinate(random, greatest) >> spread));
  bool clamped = false;
  const auto accelerated = accelerate(corners, q, clamped);
  if (!accelerated) return false;
  request.triangle = *accelerated;

  const grid_point &a = corners[random() % 3], &b = corners[random() % 3];
  const double share = random() % 3 == 0 ? 0 : (random() % 1'001) / 1'000.0;
  double aim[3], length = 0;
  for (unsigned k = 0; k < 3; ++k) {
    const double beside = random() % 2 == 0 ? 0 : static_cast<double>(random() % 17) - 8;
    request.position[k] = random() % 8 == 0 ? a[k] : coordinate(random, greatest);
    aim[k] = static_cast<double>(a[k]) + share * static_cast<double>(b[k] - a[k]) + beside - static_cast<double>(request.position[k]);
    length = std::hypot(length, aim[k]);
  }
  if (length == 0) return false;
  // Some directions are short, so that the distance is long.
  const double one = static_cast<double>(q.greatest_direction()) / (random() % 4 == 0 ? 1 + random() % 8 : 1);
  for (unsigned k = 0; k < 3; ++k) request.direction[k] = std::llrint(aim[k] / length * one);
  return true;
}

}  // namespace

TEST_CASE("triangle_intersector: hit_only tells what the registers do, of the golden pairs", "[triangle_unit]") {
  for (const bool as_built : {true, false}) {
    const triangle_intersector intersect({}, as_built ? test::triangles_as_built : triangle_errata{});
    counts c;
    std::size_t row = 0;
    for (const test::triangle_vector& v : test::golden_triangles()) {
      CAPTURE(row, as_built);
      REQUIRE(agrees(intersect, v.request, c));
      ++row;
    }
    CHECK(c.pairs == 14'000);
    CHECK(c.hits > 2'000);
    CHECK(c.early > 4'000);
  }
}

TEST_CASE("triangle_intersector: hit_only tells what the registers do, at any width, with any errata, of any words", "[triangle_unit]") {
  test::rng random(31);
  counts words, grazing;
  for (int design = 0; design < 4'000; ++design) {
    quantisation q = test::random_words(random);
    // Hits are seldom among random words, but of the smallest.
    if (design % 4 == 0) q = {4 + random() % 3, 4 + random() % 4, random() % 3, 0, 0};
    const triangle_intersector intersect(q, test::random_errata(random), random() % 8 == 0);
    for (int i = 0; i < 300; ++i) {
      triangle_request request;
      const bool graze = i % 2 == 0;
      if (graze && !grazing_pair(random, q, request)) continue;
      if (!graze) request = test::random_request(random, q);
      if (agrees(intersect, request, graze ? grazing : words)) continue;
      CAPTURE(q.n, q.m, q.edge_shift, q.division_drop, design, i);
      REQUIRE(false);
    }
  }
  CHECK(words.early > 100'000);
  CHECK(words.hits > 5'000);
  CHECK(grazing.early > 10'000);
  CHECK(grazing.hits > 10'000);
}

TEST_CASE("triangle_intersector: hit_only tells what the registers do, near the edges of triangles of the real widths", "[triangle_unit]") {
  test::rng random(32);
  for (const triangle_errata& errata : {test::triangles_as_built, triangle_errata{}}) {
    const quantisation q;
    const triangle_intersector intersect(q, errata);
    counts c;
    for (int i = 0; i < 400'000; ++i) {
      triangle_request request;
      if (!grazing_pair(random, q, request)) continue;
      CAPTURE(i);
      if (!agrees(intersect, request, c)) REQUIRE(false);
    }
    CAPTURE(c.pairs, c.hits, c.early);
    CHECK(c.hits > 20'000);
    CHECK(c.early > 20'000);
  }
}

TEST_CASE("triangle_intersector: a numerator of -2^(n+2) has no magnitude in its register", "[triangle_unit]") {
  // t is then 0 and the ray hits where it starts, however far the plane.
  const quantisation q{8, 10, 0, 0, 0};
  const accelerated_triangle level{0, 0, -1024, 8, 0, 0, 8, 0, 0, 2};
  triangle_errata built;
  built.den_wraps = true;
  const triangle_intersector intersect(q, built);
  const per_axis<std::int64_t> position{10, 10, 0}, direction{-120, -120, -511};
  const triangle_outcome all = intersect(position, direction, level);
  CHECK(all.hit);
  CHECK(all.t == 0);
  CHECK(intersect.hit_only(position, direction, level).hit);
}

}  // namespace rtusim
