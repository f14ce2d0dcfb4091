#include "modules/triangle_unit/triangle_lists.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/numeric/avx2.h"
#include "modules/numeric/fixed_point.h"
#include "testbench/tests/random_triangles.h"

namespace rtusim {
namespace {

/// Errors and wrapped of those that are told, by the intersector; none of them hits.
triangle_lists::verdict by_intersector(const triangle_intersector& intersect, const quantised_ray& ray,
                                       const std::vector<accelerated_triangle>& triangles, const std::vector<std::uint32_t>& numbers,
                                       std::uint32_t first, std::uint32_t count, std::uint64_t open) {
  triangle_lists::verdict v{open, 0, 0};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (open >> i & 1) continue;
    const triangle_outcome o = intersect(ray.position, ray.direction, triangles[numbers[first + i]]);
    REQUIRE_FALSE(o.hit);
    v.errors += o.err;
    v.wrapped += o.wrapped;
  }
  return v;
}

/// Words of the widths, now and then at their ends.
std::int64_t random_word(test::rng& random, unsigned bits) {
  const std::int64_t greatest = (std::int64_t{1} << (bits - 1)) - 1;
  switch (random() % 8) {
    case 0: return greatest;
    case 1: return -greatest - 1;
    case 2: return -greatest;
    case 3: return static_cast<std::int64_t>(random() % 3) - 1;
    default: break;
  }
  const auto word = static_cast<std::int64_t>(std::uint64_t{random()} << 32 | random());
  return numeric::wrap(word >> random() % 64, bits);
}

struct tally {
  std::uint64_t pairs = 0, open = 0, errors = 0, wrapped = 0;
};

void check(const triangle_lists& lists, const triangle_intersector& intersect, const quantised_ray& ray,
           const std::vector<accelerated_triangle>& triangles, const std::vector<std::uint32_t>& numbers, std::uint32_t first,
           std::uint32_t count, tally& sums) {
  const triangle_lists::verdict found = lists(ray.position, ray.direction, first, count);
  REQUIRE((count == 64 || found.open >> count == 0));
  const triangle_lists::verdict wanted = by_intersector(intersect, ray, triangles, numbers, first, count, found.open);
  REQUIRE(found.errors == wanted.errors);
  REQUIRE(found.wrapped == wanted.wrapped);
  sums.pairs += count;
  sums.open += static_cast<std::uint64_t>(__builtin_popcountll(found.open));
  sums.errors += found.errors;
  sums.wrapped += found.wrapped;
}

}  // namespace

TEST_CASE("triangle_lists: what is told of many at a time is what the intersector tells of each", "[triangle_unit]") {
  if (!triangle_lists::covers({}, {})) {
    CHECK_FALSE(numeric::has_avx2());
    return;
  }
  test::rng random(2007);
  tally sums;
  for (int round = 0; round < 300; ++round) {
    design d = test::random_triangle_design(random);
    quantisation& words = d.of<bih_kind>().words;
    triangle_errata& errata = d.of<bih_kind>().intersector.errata;
    errata.den_wraps = errata.num_wraps = false;
    words.division_drop = 0;
    words.n = std::min(words.n, 30u);
    words.m = std::min(words.m, 32u);
    REQUIRE(triangle_lists::covers(words, errata));
    const bih_memory model = test::random_triangles(random, d);
    const triangle_intersector intersect(words, errata);
    std::vector<std::uint32_t> numbers(model.triangles.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    std::shuffle(numbers.begin(), numbers.end(), random);
    const triangle_lists lists(words, numbers, model.triangles);
    const ray_setup setup(words, model.corner);
    CAPTURE(round, words.n, words.m, words.edge_shift);
    for (std::uint32_t id = 0; id < 30; ++id) {
      triangle_job job;
      ray_setup_stats ignored;
      setup(test::random_triangle_packet(random, id, d, model), ignored, job);
      const auto first = static_cast<std::uint32_t>(random() % numbers.size());
      const auto count = 1 + static_cast<std::uint32_t>(random() % std::min<std::size_t>(64, numbers.size() - first));
      check(lists, intersect, job.ray, model.triangles, numbers, first, count, sums);
    }
  }
  CHECK(sums.pairs > 100'000);
  CHECK(sums.open < sums.pairs / 4);
  CHECK(sums.errors > 20'000);
}

TEST_CASE("triangle_lists: any words", "[triangle_unit]") {
  if (!numeric::has_avx2()) return;
  test::rng random(1957);
  tally sums;
  for (int round = 0; round < 400; ++round) {
    quantisation words;
    words.n = 4 + random() % 27;
    words.m = 4 + random() % 29;
    words.edge_shift = random() % 21;
    const triangle_intersector intersect(words, {});
    std::vector<accelerated_triangle> triangles(1 + random() % 100);
    for (accelerated_triangle& t : triangles) {
      t.pp = random_word(random, words.n + 1) & words.greatest_coordinate();
      t.pq = random_word(random, words.n + 1) & words.greatest_coordinate();
      t.d = random_word(random, words.n + 3);
      for (auto* word : {&t.e1p, &t.e1q, &t.e2p, &t.e2q, &t.np, &t.nq}) *word = random_word(random, words.m);
      t.r = random() % 4;
    }
    std::vector<std::uint32_t> numbers(triangles.size());
    for (std::uint32_t& n : numbers) n = static_cast<std::uint32_t>(random() % triangles.size());
    const triangle_lists lists(words, numbers, triangles);
    CAPTURE(round, words.n, words.m, words.edge_shift);
    for (int k = 0; k < 40; ++k) {
      quantised_ray ray;
      for (unsigned i = 0; i < 3; ++i) {
        ray.position[i] =
            random_word(random, words.n + 2) & (random() % 16 == 0 ? 2 * words.greatest_coordinate() + 1 : words.greatest_coordinate());
        ray.direction[i] = random_word(random, words.m);
      }
      const auto first = static_cast<std::uint32_t>(random() % numbers.size());
      const auto count = 1 + static_cast<std::uint32_t>(random() % std::min<std::size_t>(64, numbers.size() - first));
      check(lists, intersect, ray, triangles, numbers, first, count, sums);
    }
  }
  CHECK(sums.pairs > 200'000);
  CHECK(sums.wrapped > 1'000);
  CHECK(sums.open > 10'000);
}

TEST_CASE("triangle_lists: numbers that name no triangle are left to whoever checks them", "[triangle_unit]") {
  if (!numeric::has_avx2()) return;
  const std::vector<accelerated_triangle> one(1);
  const triangle_lists lists({}, {0, 7, 0, 9, 0}, one);
  const triangle_lists::verdict v = lists({5, 6, 7}, {0, 0, 1 << 30}, 0, 5);
  CHECK((v.open & 0b01010) == 0b01010);
}

TEST_CASE("triangle_lists: which words are covered", "[triangle_unit]") {
  const auto covers = [](unsigned n, unsigned m, unsigned drop, triangle_errata errata = {}) {
    quantisation q;
    q.n = n;
    q.m = m;
    q.division_drop = drop;
    return triangle_lists::covers(q, errata);
  };
  CHECK(covers(30, 32, 0) == numeric::has_avx2());
  CHECK_FALSE(covers(31, 32, 0));
  CHECK_FALSE(covers(30, 33, 0));
  CHECK_FALSE(covers(30, 32, 1));
  triangle_errata den, num, others;
  den.den_wraps = num.num_wraps = true;
  CHECK_FALSE(covers(30, 32, 0, den));
  CHECK_FALSE(covers(30, 32, 0, num));
  others.t_halved = others.uv_low_bits = others.uv_below_one = others.t_zero_by_sign = true;
  CHECK(covers(30, 32, 0, others) == numeric::has_avx2());
}

}  // namespace rtusim
