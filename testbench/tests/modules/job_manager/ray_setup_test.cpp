#include "modules/job_manager/ray_setup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/job_manager/triangle_job_manager.h"
#include "testbench/tests/pipeline_run.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

__extension__ using int128 = __int128;

std::uint32_t binary32_bits(double value) {
  const auto rounded = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return bits;
}

double value_of(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

job_packet packet_of(const per_axis<double>& origin, const per_axis<double>& direction, std::uint32_t id = 0) {
  job_packet p;
  p.job_word = id;
  for (unsigned i = 0; i < 3; ++i) {
    p.t0[i] = binary32_bits(origin[i]);
    p.t1[i] = binary32_bits(direction[i]);
  }
  return p;
}

/// A ray at the box or past it, in 2^n grid units; the origin is a whole number of grid units at n = 30 or at any smaller.
job_packet random_packet(test::rng& random, std::uint32_t id) {
  const auto uniform = [&](double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); };
  per_axis<double> origin, direction;
  double sum = 0;
  for (unsigned i = 0; i < 3; ++i) {
    origin[i] = random() % 16 == 0 ? 0 : uniform(-2, 3);
    direction[i] = random() % 16 == 0 ? 0 : random() % 4 == 0 ? uniform(-1, 1) : uniform(0, 1) - origin[i];
    sum += std::fabs(direction[i]);
  }
  if (sum > 0)
    for (double& d : direction) d /= sum;
  return packet_of(origin, direction, id);
}

std::string text_of(const triangle_job& j) {
  const quantised_ray& r = j.ray;
  std::string text = fmt::format("{} {} {}", j.job_word, j.sequence, static_cast<int>(r.misses_box));
  for (const auto* words : {&r.position, &r.direction, &r.reciprocal})
    for (const std::int64_t word : *words) text += fmt::format(" {}", word);
  return text;
}

}  // namespace

TEST_CASE("ray_setup: a table of rays", "[job_manager]") {
  // A box of 64 x 32 x 16 grid units of 2^8; 1.0 of directions is 512, 1.0 of reciprocals 16.
  const quantisation q{8, 10, 4, 4, 0};
  const ray_setup setup(q, {64, 32, 16});
  constexpr std::int64_t most = (1 << 13) - 1;
  struct row {
    const char* name;
    per_axis<double> origin;  // in grid units
    per_axis<double> direction;
    per_axis<std::int64_t> position, words, reciprocal;
    bool misses, clipped;
    unsigned flat;
  };
  const row table[] = {
      {"from inside", {10, 20, 5}, {0.5, -0.25, 0.25}, {10, 20, 5}, {256, -128, 128}, {32, -64, 64}, false, false, 0},
      {"part of a grid unit is cut",
       {10.75, 20.25, 5.5},
       {0.5, -0.25, 0.25},
       {10, 20, 5},
       {256, -128, 128},
       {32, -64, 64},
       false,
       false,
       0},
      {"+-1.0 is 511", {10, 20, 5}, {1, 0, 0}, {10, 20, 5}, {511, 0, 0}, {16, most, most}, false, false, 2},
      {"the other way", {10, 20, 5}, {0, -1, 0}, {10, 20, 5}, {0, -511, 0}, {most, -16, most}, false, false, 2},
      {"beyond 1.0", {10, 20, 5}, {0, 0, 1.75}, {10, 20, 5}, {0, 0, 511}, {most, most, 16}, false, false, 2},
      {"the smallest words", {10, 20, 5}, {1.0 / 512, -1.0 / 512, 0.5}, {10, 20, 5}, {1, -1, 256}, {most, -most - 1, 32}, false, false, 0},
      {"from outside along x", {-100, 20, 5}, {0.5, 0, 0}, {0, 20, 5}, {256, 0, 0}, {32, most, most}, false, true, 2},
      {"from outside against x", {100, 20, 5}, {-0.5, 0, 0}, {64, 20, 5}, {-256, 0, 0}, {-32, most, most}, false, true, 2},
      {"across two slabs", {-8, -8, 5}, {0.5, 0.25, 0}, {8, 0, 5}, {256, 128, 0}, {32, 64, most}, false, true, 1},
      {"past the box", {-8, -80, 5}, {0.5, 0.25, 0}, {64, 0, 5}, {256, 128, 0}, {32, 64, most}, true, false, 1},
      {"to the corner itself", {-64, -32, 5}, {0.5, 0.25, 0}, {0, 0, 5}, {256, 128, 0}, {32, 64, most}, false, true, 1},
      {"through the last corner", {32, 48, 5}, {0.25, -0.125, 0}, {64, 32, 5}, {128, -64, 0}, {64, -128, most}, false, true, 1},
      {"parallel in the slab", {-8, 32, 16}, {0.5, 0, 0}, {0, 32, 16}, {256, 0, 0}, {32, most, most}, false, true, 2},
      {"parallel outside of it", {-8, 33, 16}, {0.5, 0, 0}, {0, 32, 16}, {256, 0, 0}, {32, most, most}, true, false, 2},
      {"parallel below it", {10, 20, -1}, {0.5, 0.5, 0}, {10, 20, 0}, {256, 256, 0}, {32, 32, most}, true, false, 1},
      {"away from it", {65, 20, 5}, {0.5, 0, 0}, {64, 20, 5}, {256, 0, 0}, {32, most, most}, true, false, 2},
      {"away from a face", {64, 20, 5}, {0.5, 0, 0}, {64, 20, 5}, {256, 0, 0}, {32, most, most}, false, false, 2},
      {"no direction", {10, 20, 5}, {0, 0, 0}, {10, 20, 5}, {0, 0, 0}, {most, most, most}, false, false, 3},
  };
  for (const row& r : table) {
    CAPTURE(r.name);
    per_axis<double> origin;
    for (unsigned i = 0; i < 3; ++i) origin[i] = r.origin[i] / 256;
    ray_setup_stats stats;
    triangle_job job;
    job.sequence = 77;
    setup(packet_of(origin, r.direction, 5), stats, job);
    CHECK(job.job_word == 5);
    CHECK(job.sequence == 77);
    CHECK(job.ray.position == r.position);
    CHECK(job.ray.direction == r.words);
    CHECK(job.ray.reciprocal == r.reciprocal);
    CHECK(job.ray.misses_box == r.misses);
    CHECK(stats.missed_box == r.misses);
    CHECK(stats.clipped == r.clipped);
    CHECK(stats.flat_components == r.flat);
    CHECK(stats.conversion.conversions == 6);
    CHECK(stats.conversion.overflows + stats.conversion.nans == 0);
  }
}

TEST_CASE("ray_setup: words that are no number, infinite or far too large are counted, and the ray stays in the box", "[job_manager]") {
  const quantisation q;
  const per_axis<std::int64_t> corner{q.greatest_coordinate(), 1'000'000, 500'000'000};
  const ray_setup setup(q, corner);
  const std::uint32_t nan = 0x7fc00000, negative_nan = 0xffc00001, infinity = 0x7f800000, minus_infinity = 0xff800000;
  struct row {
    const char* name;
    std::uint32_t origin, direction;  // of y
    std::uint64_t nans, overflows;
    std::int64_t word;  // of the direction
    bool misses;
  };
  const std::int64_t most = q.greatest_direction();
  const std::uint32_t inside = binary32_bits(0.0001), up = binary32_bits(0.25);
  const row table[] = {
      {"an origin that is none", nan, up, 1, 0, 1 << 29, true},
      {"a negative one", negative_nan, up, 1, 0, 1 << 29, true},
      {"an endless origin", infinity, up, 0, 1, 1 << 29, true},
      {"the other way", minus_infinity, up, 0, 1, 1 << 29, true},
      {"an eye 40,000 scenes away", binary32_bits(40'000), up, 0, 1, 1 << 29, true},
      {"a direction that is none", inside, nan, 1, 0, most, false},
      {"a negative one", inside, negative_nan, 1, 0, -most, false},
      {"an endless direction", inside, infinity, 0, 1, most, false},
      {"the other way", inside, minus_infinity, 0, 1, -most, false},
      {"a direction of 2", inside, binary32_bits(2), 0, 1, most, false},
      {"all of it", nan, infinity, 1, 1, most, true},
  };
  for (const row& r : table) {
    CAPTURE(r.name);
    job_packet p = packet_of({0.5, 0, 0.25}, {0.5, 0, 0.25});
    p.t0[1] = r.origin;
    p.t1[1] = r.direction;
    ray_setup_stats stats;
    triangle_job job;
    setup(p, stats, job);
    CHECK(stats.conversion.nans == r.nans);
    CHECK(stats.conversion.overflows == r.overflows);
    CHECK(job.ray.direction[1] == r.word);
    CHECK(job.ray.misses_box == r.misses);
    for (unsigned i = 0; i < 3; ++i) {
      CHECK(job.ray.position[i] >= 0);
      CHECK(job.ray.position[i] <= corner[i]);
    }
  }
}

TEST_CASE("ray_setup: a ray enters the box where it does in real numbers, within 2 grid units", "[job_manager]") {
  test::rng random(41);
  unsigned entered = 0, missed = 0, inside = 0;
  for (int scene = 0; scene < 200; ++scene) {
    quantisation q;
    if (scene % 2 != 0) q = {8 + random() % 25, 8 + random() % 27, 10, random() % 29, 0};
    per_axis<std::int64_t> corner;
    for (std::int64_t& c : corner) c = 1 + static_cast<std::int64_t>(random()) % q.greatest_coordinate();
    corner[random() % 3] = q.greatest_coordinate();
    const ray_setup setup(q, corner);
    for (int i = 0; i < 500; ++i) {
      const job_packet p = random_packet(random, 0);
      ray_setup_stats stats;
      triangle_job job;
      setup(p, stats, job);
      CAPTURE(scene, i, q.n, q.m);
      long double origin[3], direction[3], enter = 0, leave = 1e30L;
      for (unsigned k = 0; k < 3; ++k) {
        origin[k] = std::trunc(std::ldexp(static_cast<long double>(value_of(p.t0[k])), static_cast<int>(q.n)));
        direction[k] = std::ldexp(static_cast<long double>(job.ray.direction[k]), 1 - static_cast<int>(q.m));
        // The word is the float's, cut.
        const long double whole = std::trunc(std::ldexp(static_cast<long double>(value_of(p.t1[k])), static_cast<int>(q.m) - 1));
        const auto one = static_cast<long double>(q.greatest_direction());
        REQUIRE(static_cast<long double>(job.ray.direction[k]) == std::clamp(whole, -one, one));
        const auto side = static_cast<long double>(corner[k]);
        if (direction[k] == 0) {
          if (origin[k] < 0 || origin[k] > side) leave = -1;
          continue;
        }
        const long double a = -origin[k] / direction[k], b = (side - origin[k]) / direction[k];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (std::fabs(enter - leave) > 2) REQUIRE(job.ray.misses_box == (enter > leave));
      REQUIRE(stats.missed_box == job.ray.misses_box);
      missed += job.ray.misses_box;
      if (job.ray.misses_box || enter > leave) continue;
      (stats.clipped != 0 ? entered : inside) += 1;
      if (stats.clipped != 0) REQUIRE(enter > 0);
      for (unsigned k = 0; k < 3; ++k) {
        const long double exact = origin[k] + enter * direction[k];
        REQUIRE(std::fabs(static_cast<long double>(job.ray.position[k]) - exact) <= 2);
        REQUIRE(job.ray.position[k] >= 0);
        REQUIRE(job.ray.position[k] <= corner[k]);
      }
    }
  }
  CHECK(entered > 10'000);
  CHECK(missed > 10'000);
  CHECK(inside > 500);
}

TEST_CASE("ray_setup: the reciprocal is the truncated ratio, saturated, of every word of few bits and of random ones", "[job_manager]") {
  const auto check = [](const ray_setup& setup, const quantisation& q, std::int64_t direction) {
    const std::int64_t most = (std::int64_t{1} << (q.m + q.reciprocal_bits - 2)) - 1 + (std::int64_t{1} << (q.m + q.reciprocal_bits - 2));
    const int128 one = int128{1} << (q.m - 1 + q.reciprocal_bits);
    const int128 wanted = direction == 0 ? int128{most} : std::clamp<int128>(one / direction, int128{-most} - 1, int128{most});
    if (setup.reciprocal(direction) == static_cast<std::int64_t>(wanted)) return;
    CAPTURE(q.m, q.reciprocal_bits, direction);
    REQUIRE(setup.reciprocal(direction) == static_cast<std::int64_t>(wanted));
  };
  for (unsigned m = 4; m <= 14; ++m)
    for (unsigned bits = 0; bits <= 28; ++bits) {
      const quantisation q{8, m, 4, bits, 0};
      const ray_setup setup(q, {1, 1, 1});
      for (std::int64_t d = -(std::int64_t{1} << (m - 1)); d < std::int64_t{1} << (m - 1); ++d) check(setup, q, d);
    }
  test::rng random(43);
  for (unsigned m = 15; m <= 34; ++m)
    for (unsigned bits = 0; bits <= 28; ++bits) {
      const quantisation q{30, m, 10, bits, 0};
      const ray_setup setup(q, {1, 1, 1});
      const std::int64_t end = std::int64_t{1} << (m - 1);
      for (const std::int64_t d :
           {-end, -end + 1, std::int64_t{-2}, std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}, std::int64_t{2}, end - 1})
        check(setup, q, d);
      for (int i = 0; i < 200; ++i)
        check(setup, q,
              static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) % (2 * static_cast<std::uint64_t>(end))) - end);
    }
}

TEST_CASE("triangle_job_manager: ray_setup's jobs in order behind its stages, whatever source and sink do", "[job_manager]") {
  test::rng random(44);
  std::vector<job_packet> packets;
  for (std::uint32_t id = 0; id < 300; ++id) packets.push_back(random_packet(random, id));
  const quantisation words[] = {{}, {12, 14, 4, 0, 0}, {4, 4, 0, 28, 0}, {32, 34, 20, 28, 0}};
  const unsigned stages[] = {1 + 5 + 64 + 2, 1 + 5 + 28 + 2, 1 + 5 + 33 + 2, 1 + 5 + 68 + 2};
  for (std::size_t which = 0; which < std::size(words); ++which) {
    const quantisation& q = words[which];
    const triangle_job_manager::params p{q, {q.greatest_coordinate(), 7, q.greatest_coordinate() / 2}};
    CAPTURE(which);
    REQUIRE(triangle_job_manager::stages_of(p) == stages[which]);
    const ray_setup setup(q, p.corner);
    std::string wanted;
    for (std::uint32_t i = 0; i < packets.size(); ++i) {
      ray_setup_stats stats;
      triangle_job job;
      job.sequence = i;
      setup(packets[i], stats, job);
      wanted += text_of(job) + '\n';
    }
    std::string first;
    for (const auto& paces : test::stalled_runs(1 + static_cast<std::uint32_t>(which))) {
      std::string log;
      for (const test::pipeline_run& run : paces) {
        const std::string other = test::pipeline_log<triangle_job_manager, job_packet, triangle_job>(p, packets, run, text_of);
        REQUIRE(test::payloads(other) == wanted);
        if (log.empty()) log = other;
        REQUIRE(other == log);
      }
      if (first.empty()) first = log;  // without waits
    }
    CHECK_THAT(first, Catch::StartsWith("0 in \n1 in \n") &&
                          Catch::Contains(fmt::format("\n{} out {}\n", stages[which], wanted.substr(0, wanted.find('\n')))));
  }
}

}  // namespace rtusim
