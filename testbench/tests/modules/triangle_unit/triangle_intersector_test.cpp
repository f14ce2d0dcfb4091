#include "modules/triangle_unit/triangle_intersector.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "modules/config/error.h"
#include "scenes/triangles/quantised_triangles.h"
#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"

namespace rtusim {
namespace {

__extension__ using int128 = __int128;

bool same(const triangle_outcome& a, const triangle_outcome& b) {
  return a.u == b.u && a.v == b.v && a.t == b.t && a.hit == b.hit && a.err == b.err && a.wrapped == b.wrapped;
}

triangle_outcome outcome_of(const triangle_intersector& intersect, const triangle_request& q) {
  return intersect(q.position, q.direction, q.triangle);
}

std::int64_t floor_ratio(int128 a, int128 b) {
  const int128 q = a / b;
  return static_cast<std::int64_t>(q - (a % b != 0 && (a < 0) != (b < 0)));
}

/// The test in whole numbers without end: no register wraps.
triangle_outcome unlimited(const triangle_request& request, const quantisation& q) {
  const accelerated_triangle& a = request.triangle;
  const unsigned r = a.r, p_axis = (r + 1) % 3, q_axis = (r + 2) % 3;
  const int128 unit = int128{1} << (q.m - 1);
  const auto scaled = [&](int128 x, int128 y) { return floor_ratio(x * y, unit); };
  const auto &o = request.position, &dir = request.direction;
  const int128 num = int128{a.d} - o[r] - scaled(o[p_axis], a.np) - scaled(o[q_axis], a.nq);
  const int128 den = int128{dir[r]} + scaled(dir[p_axis], a.np) + scaled(dir[q_axis], a.nq);
  triangle_outcome result;
  result.err = den == 0 || (num < 0) != (den < 0) || floor_ratio(num * unit, den) >= int128{1} << (q.n + 1);
  if (result.err) return result;
  const std::int64_t t = floor_ratio(num * unit, den);
  const int128 kp = o[p_axis] + scaled(t, dir[p_axis]) - a.pp, kq = o[q_axis] + scaled(t, dir[q_axis]) - a.pq;
  const int128 u = a.e1p * kq - a.e1q * kp, v = a.e2q * kp - a.e2p * kq;
  result.t = static_cast<std::uint64_t>(t);
  result.hit = num != 0 && u >= 0 && v >= 0 && u + v <= unit << q.edge_shift;
  return result;
}

/// A triangle in the scene, of any size and shape, and a ray from within it; most rays aim at it.
bool random_pair(test::rng& random, const quantisation& q, triangle_request& request) {
  const std::int64_t greatest = q.greatest_coordinate();
  const auto coordinate = [&] {
    return static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) & static_cast<std::uint64_t>(greatest));
  };
  std::array<grid_point, 3> corners;
  const unsigned spread = random() % (q.n + 1);
  for (grid_point& c : corners)
    for (unsigned k = 0; k < 3; ++k) {
      c[k] = coordinate();
      if (&c != &corners[0]) c[k] = std::min(greatest, corners[0][k] + (c[k] >> spread));
      if (random() % 16 == 0) c[k] = random() % 2 == 0 ? 0 : greatest;
    }
  bool clamped = false;
  const auto accelerated = accelerate(corners, q, clamped);
  if (!accelerated) return false;
  request.triangle = *accelerated;
  for (std::int64_t& word : request.position) word = coordinate();
  double weights[3], sum = 0;
  for (double& w : weights) sum += w = random() % 16 == 0 ? 0 : random() % 1000 + 1;
  double aim[3], length = 0;
  for (unsigned k = 0; k < 3; ++k) {
    aim[k] = static_cast<double>(coordinate() - request.position[k]);
    if (random() % 8 != 0 && sum > 0) {
      aim[k] = -static_cast<double>(request.position[k]);
      for (unsigned i = 0; i < 3; ++i) aim[k] += static_cast<double>(corners[i][k]) * weights[i] / sum;
    }
    length = std::hypot(length, aim[k]);
  }
  if (length == 0) return false;
  const double greatest_direction = static_cast<double>(q.greatest_direction());
  for (unsigned k = 0; k < 3; ++k) request.direction[k] = std::llrint(aim[k] / length * greatest_direction);
  return true;
}

}  // namespace

TEST_CASE("triangle_intersector: every row of the golden file, in 64 and in 128 bits", "[triangle_unit]") {
  const auto rows = test::golden_triangles();
  REQUIRE(rows.size() == 14'000);
  for (const bool wide : {false, true}) {
    const triangle_intersector intersect({}, test::triangles_as_built, wide);
    CHECK(intersect.divider_width() == 33);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const triangle_outcome o = outcome_of(intersect, rows[row].request);
      const triangle_result& r = rows[row].result;
      if (o.u == r.u && o.v == r.v && o.t == r.t && o.hit == r.hit) continue;
      CAPTURE(row, wide);
      CHECK(o.u == r.u);
      CHECK(o.v == r.v);
      CHECK(o.t == r.t);
      REQUIRE(o.hit == r.hit);
    }
  }
}

TEST_CASE("triangle_intersector: 64 bits give what 128 bits give, at any width, with any errata, of any words", "[triangle_unit]") {
  test::rng random(7);
  unsigned narrow = 0;
  for (int design = 0; design < 2'000; ++design) {
    const quantisation q = test::random_words(random);
    const triangle_errata errata = test::random_errata(random);
    narrow += q.n + q.m + 2 <= 64 && q.m <= 32;
    const triangle_intersector either(q, errata), wide(q, errata, true);
    for (int i = 0; i < 100; ++i) {
      const triangle_request request = test::random_request(random, q);
      if (same(outcome_of(either, request), outcome_of(wide, request))) continue;
      CAPTURE(q.n, q.m, q.edge_shift, q.division_drop, design, i);
      REQUIRE(false);
    }
  }
  CHECK(narrow > 1'500);
}

TEST_CASE("triangle_intersector: without errata no register of rays and triangles in the scene is too short", "[triangle_unit]") {
  test::rng random(8);
  unsigned hits = 0, misses = 0, wrapped = 0;
  for (int design = 0; design < 500; ++design) {
    quantisation q = test::random_words(random);
    q.division_drop = 0;
    const triangle_intersector intersect(q, {});
    for (int i = 0; i < 400; ++i) {
      triangle_request request;
      if (!random_pair(random, q, request)) continue;
      const triangle_outcome o = outcome_of(intersect, request), exact = unlimited(request, q);
      CAPTURE(q.n, q.m, q.edge_shift, design, i);
      REQUIRE(o.err == exact.err);
      REQUIRE(o.hit == exact.hit);
      if (!o.err) REQUIRE(o.t == exact.t);
      (o.hit ? hits : misses) += 1;
      wrapped += o.wrapped;
    }
  }
  CHECK(hits > 10'000);
  CHECK(misses > 10'000);
  CHECK(wrapped > 10'000);
}

TEST_CASE("triangle_intersector: agreement with the exact test, as built and without errata", "[triangle_unit]") {
  struct share {
    unsigned agree = 0, all = 0;
    void add(bool same) {
      agree += same;
      ++all;
    }
    double percent() const { return 100.0 * agree / all; }
  };
  const triangle_intersector as_built({}, test::triangles_as_built), right({}, {});
  share built_all, built_sound, built_clear, right_clear, right_wrapped, right_all;
  const std::int64_t clamped_edge = quantisation{}.greatest_direction();
  for (const test::triangle_vector& v : test::golden_triangles()) {
    if (v.exact_hit < 0) continue;
    const triangle_outcome o = outcome_of(as_built, v.request);
    const bool built = o.hit == (v.exact_hit == 1), better = outcome_of(right, v.request).hit == (v.exact_hit == 1);
    built_all.add(built);
    right_all.add(better);
    const accelerated_triangle& a = v.request.triangle;
    bool clamped = false;
    for (const std::int64_t e : {a.e1p, a.e1q, a.e2p, a.e2q}) clamped |= std::abs(e) == clamped_edge;
    if (clamped) continue;
    built_clear.add(built);
    right_clear.add(better);
    if (o.wrapped)
      right_wrapped.add(better);
    else
      built_sound.add(built);
  }
  CHECK(built_all.all == 12'268);
  CHECK(built_all.percent() == Approx(83.83).margin(0.005));
  CHECK(built_sound.percent() == Approx(97.80).margin(0.005));
  // What is left is at edges, and at rays that start in the plane.
  CHECK(built_clear.percent() == Approx(86.56).margin(0.005));
  CHECK(right_clear.percent() == Approx(97.32).margin(0.005));
  CHECK(right_wrapped.percent() > 96);
  CHECK(right_all.percent() > 94);
}

TEST_CASE("triangle_intersector: each erratum by itself", "[triangle_unit]") {
  const quantisation q{8, 10, 4, 0, 0};
  bool clamped = false;
  // In the plane z = 100, with legs of 64 along x and y: edges of 1/64, 128 raw; a direction of 1.0 is 511.
  const accelerated_triangle level = *accelerate({grid_point{0, 0, 100}, grid_point{64, 0, 100}, grid_point{0, 64, 100}}, q, clamped);
  CHECK(level.e1p == 128);
  const auto shoot = [&](const triangle_errata& errata, const grid_point& from, const grid_point& direction,
                         const accelerated_triangle& at) { return triangle_intersector(q, errata)(from, direction, at); };
  triangle_errata t_halved, uv_low_bits, uv_below_one, t_zero_by_sign, den_wraps, num_wraps;
  t_halved.t_halved = uv_low_bits.uv_low_bits = uv_below_one.uv_below_one = t_zero_by_sign.t_zero_by_sign = true;
  den_wraps.den_wraps = num_wraps.num_wraps = true;

  const triangle_outcome up = shoot({}, {16, 8, 0}, {0, 0, 511}, level);
  CHECK(up.hit);
  CHECK(up.t == 100);
  CHECK(up.u == 64);   // 8/64 of 512
  CHECK(up.v == 128);  // 16/64
  CHECK(shoot(t_halved, {16, 8, 0}, {0, 0, 511}, level).t == 50);
  CHECK(shoot(uv_low_bits, {16, 8, 0}, {0, 0, 511}, level).v == (128 * 16) % 1024);
  CHECK(shoot({}, {16, 8, 200}, {0, 0, 511}, level).err);
  CHECK(shoot({}, {16, 8, 200}, {0, 0, -511}, level).hit);

  CHECK(shoot({}, {32, 32, 0}, {0, 0, 511}, level).hit);
  CHECK_FALSE(shoot(uv_below_one, {32, 32, 0}, {0, 0, 511}, level).hit);
  CHECK_FALSE(shoot({}, {33, 32, 0}, {0, 0, 511}, level).hit);

  for (const std::int64_t z : {511, -511}) {
    CHECK_FALSE(shoot({}, {16, 8, 100}, {0, 0, z}, level).hit);
    CHECK(shoot(t_zero_by_sign, {16, 8, 100}, {0, 0, z}, level).hit == (z > 0));
  }

  // In the plane x + y + z = 240, along its normal: the denominator is sqrt 3.
  const accelerated_triangle tilted = *accelerate({grid_point{240, 0, 0}, grid_point{0, 240, 0}, grid_point{0, 0, 240}}, q, clamped);
  const triangle_outcome through = shoot({}, {10, 20, 30}, {295, 295, 295}, tilted);
  CHECK(through.hit);
  CHECK(through.wrapped);
  CHECK(through.t == 105);  // 182 / 1.725: np and nq are 511/512
  CHECK_FALSE(shoot(den_wraps, {10, 20, 30}, {295, 295, 295}, tilted).hit);
  // From beyond 2^(n+1) along the normal: S is 690.
  const triangle_outcome back = shoot({}, {230, 230, 230}, {-295, -295, -295}, tilted);
  CHECK(back.wrapped);
  CHECK(back.hit);
  CHECK_FALSE(shoot(num_wraps, {230, 230, 230}, {-295, -295, -295}, tilted).hit);
}

TEST_CASE("triangle_intersector: u + v that wraps far outside is a hit only as built", "[triangle_unit]") {
  const quantisation q{8, 10, 0, 0, 0};
  const accelerated_triangle steep{0, 0, 100, 511, -511, -511, 511, 0, 0, 2};
  triangle_errata below_one;
  below_one.uv_below_one = true;
  // t = 200 and kp = kq = 355, so u = v = 362,810: the sum, of 1,416 times 1.0, leaves 20 bits.
  CHECK(triangle_intersector(q, below_one)({255, 255, 0}, {256, 256, 256}, steep).hit);
  CHECK_FALSE(triangle_intersector(q, {})({255, 255, 0}, {256, 256, 256}, steep).hit);
}

TEST_CASE("triangle_intersector: the divider's width follows from the words", "[triangle_unit]") {
  const auto width = [](const quantisation& q, bool den_wraps) {
    triangle_errata errata;
    errata.den_wraps = den_wraps;
    return triangle_intersector(q, errata).divider_width();
  };
  CHECK(width({30, 32, 10, 16, 0}, true) == 33);
  CHECK(width({30, 32, 10, 16, 0}, false) == 35);
  CHECK(width({30, 32, 10, 16, 24}, false) == 11);
  CHECK(width({30, 8, 10, 16, 0}, true) == 33);
  CHECK(width({20, 34, 10, 16, 0}, true) == 35);
  CHECK(width({4, 4, 0, 0, 3}, true) == 4);
  CHECK_THROWS_WITH(width({8, 10, 0, 0, 8}, true), "quantisation.division_drop: 8; expected at most n - 1 = 7");
}

TEST_CASE("triangle_intersector: bits that the division drops make t coarser, and nothing else", "[triangle_unit]") {
  test::rng random(10);
  const quantisation whole;
  for (const unsigned drop : {1U, 4U, 8U, 12U}) {
    quantisation dropped;
    dropped.division_drop = drop;
    const triangle_intersector coarse(dropped, {}), fine(whole, {});
    unsigned compared = 0, agree = 0;
    for (int i = 0; i < 20'000; ++i) {
      triangle_request request;
      if (!random_pair(random, whole, request)) continue;
      const triangle_outcome c = outcome_of(coarse, request), f = outcome_of(fine, request);
      agree += c.hit == f.hit;
      if (!c.hit || !f.hit) continue;
      ++compared;
      CAPTURE(drop, i, c.t, f.t);
      if (drop > 2) REQUIRE(c.t % (std::uint64_t{1} << (drop - 2)) == 0);  // the right divider has 2 bits to spare
    }
    CHECK(compared > 1'000);
    CHECK(agree > 10'000);
  }
}

}  // namespace rtusim
