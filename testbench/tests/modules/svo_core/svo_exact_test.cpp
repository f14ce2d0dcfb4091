#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_machine.h"
#include "modules/svo_core/svo_walk.h"
#include "testbench/kinds/driver.h"
#include "testbench/tests/exact_voxels.h"

/// Machine and walk without errata against every filled cube of a small octree.
namespace rtusim {
namespace {

using namespace test;

struct seen {
  bool hit = false;
  std::int64_t t = 0;
  int axis = no_axis, sign = 0;
  cube where;
  std::uint32_t cost = 0;
};

/// The outcome of machine and walk, which agree.
seen trace(const svo_core_params& p, const traversal_job& job, const model& m) {
  svo_cube place;
  const svo_outcome o = svo_walk(p)(job, m.words(), place);
  svo_machine machine(p, m.words());
  machine.accept(job);
  for (int steps = 0; machine.now().state != svo_state::out; ++steps) {
    machine.step();
    REQUIRE(steps < 10'000);
  }
  svo_result_registers bus;
  bus.take(o, job.direction_bits(), p);
  const auto& r = machine.now();
  REQUIRE(r.hit == o.hit);
  REQUIRE(r.cost == o.cost);
  REQUIRE(r.result.t_hit == bus.t_hit);
  REQUIRE(r.result.axis == bus.axis);
  REQUIRE(r.result.sign == bus.sign);
  seen s{r.hit, r.result.t_hit, r.result.axis, r.result.sign, {}, r.cost};
  if (r.hit) {
    s.where.size = m.n >> place.levels;
    for (unsigned i = 0; i < 3; ++i) s.where.low[i] = static_cast<int>(place.place[i]) * s.where.size;
  }
  return s;
}

}  // namespace

TEST_CASE("svo_core: without errata random rays hit the nearest filled cube ahead, at its distance and by its face", "[svo_core]") {
  test::rng random(101);
  const numeric::fixed_format formats[] = {{}, {24, 24}, {4, 20}, {32, 32}};
  unsigned hits[starts] = {}, misses[starts] = {}, touched = 0, within = 0, unlike = 0;
  unsigned by_face[3][2] = {};
  for (int round = 0; round < 300; ++round) {
    const model m = random_model(random);
    svo_core_params p;
    p.format = formats[random() % 4];
    for (int ray = 0; ray < 200; ++ray) {
      const auto how = static_cast<start>(random() % starts);
      traversal_job job = random_slabs(random, 2 + random() % (p.format.width() - 7), m.n);
      move(random, job, m, how, p.format);
      if (!fits(job, p.format)) continue;
      CAPTURE(round, ray, m.n, text(job));
      bool touches = false;
      const auto wanted = nearest(job, m, false, touches);
      const seen got = trace(p, job, m);
      if (touches) {
        // It may hit what it touches, but nothing later than what it meets.
        ++touched;
        if (wanted) REQUIRE(got.hit);
        if (!got.hit) continue;
        const passage at = through(job, got.where, m.n);
        REQUIRE(std::find(m.cubes.begin(), m.cubes.end(), got.where) != m.cubes.end());
        REQUIRE(at.enter <= at.leave);
        REQUIRE(at.leave > 0);
        if (wanted) REQUIRE(at.enter <= wanted->at.enter);
        REQUIRE(int128{got.t} * m.n == std::max<int128>(at.enter, 0));
        REQUIRE(got.axis == at.axis);
        REQUIRE(got.sign == at.sign);
        continue;
      }
      REQUIRE(got.hit == wanted.has_value());
      (got.hit ? hits : misses)[how] += 1;
      if (!wanted) {
        REQUIRE(got.t == 0);
        REQUIRE(got.axis == no_axis);
        REQUIRE(got.sign == 0);
        continue;
      }
      REQUIRE(int128{got.t} * m.n == std::max<int128>(wanted->at.enter, 0));
      REQUIRE(got.axis == wanted->at.axis);
      REQUIRE(got.sign == wanted->at.sign);
      REQUIRE(got.where == wanted->where);
      within += wanted->at.enter < 0;
      ++by_face[got.axis][got.sign > 0];
      bool ignored = false;
      unlike += nearest(job, m, true, ignored)->where == wanted->where ? 0 : 1;
    }
  }
  CAPTURE(touched, within, unlike);
  CHECK(touched > 100);
  CHECK(within > 1'000);
  CHECK(unlike > 1'000);  // with a filled cube behind the origin
  for (const start how : {as_it_is, in_a_cube, on_a_plane, at_the_end, near_the_greatest_word}) {
    CAPTURE(how, hits[how], misses[how]);
    CHECK(hits[how] > 200);
    if (how != in_a_cube) CHECK(misses[how] > 200);
  }
  CHECK(hits[behind_all] == 0);
  CHECK(misses[behind_all] > 1'000);
  for (const auto& axis : by_face)
    for (const unsigned count : axis) CHECK(count > 500);
}

TEST_CASE("svo_core: with negative_t rays hit the nearest cube of the whole line, with positive_normals all look up", "[svo_core]") {
  test::rng random(102);
  svo_core_params p;
  p.negative_t = p.positive_normals = true;
  unsigned behind = 0, ahead = 0;
  for (int round = 0; round < 100; ++round) {
    const model m = random_model(random);
    for (int ray = 0; ray < 100; ++ray) {
      traversal_job job = random_slabs(random, 8 + random() % 16, m.n);
      move(random, job, m, static_cast<start>(random() % starts), p.format);
      if (!fits(job, p.format)) continue;
      CAPTURE(round, ray, m.n, text(job));
      bool touches = false;
      const auto wanted = nearest(job, m, true, touches);
      if (touches) continue;
      const seen got = trace(p, job, m);
      REQUIRE(got.hit == wanted.has_value());
      if (!wanted) continue;
      REQUIRE(int128{got.t} * m.n == wanted->at.enter);
      REQUIRE(got.axis == wanted->at.axis);
      REQUIRE(got.sign == 1);
      REQUIRE(got.where == wanted->where);
      (got.t < 0 ? behind : ahead) += 1;
    }
  }
  CHECK(behind > 500);
  CHECK(ahead > 500);
}

TEST_CASE("svo_core: of any words the halving moves a plane down by 1/2, 3/4 or 9/8 units at most, at one, two or three levels",
          "[svo_core]") {
  // Half a unit more than the mean of the planes that it is halfway between.
  test::rng random(103);
  const svo_core_params p;
  unsigned clear = 0, not_whole = 0, rays = 0, lowered = 0;
  for (int round = 0; round < 200; ++round) {
    const model m = random_model(random);
    const int128 most = m.n == 2 ? 1 : m.n == 4 ? 3 : 9;  // as distances are, times n
    for (int ray = 0; ray < 100; ++ray) {
      const traversal_job job = random_slabs(random, 3 + random() % 22, 1);
      const auto may_be_met = [&](const passage& at) { return at.enter - most <= at.leave && at.leave > 0; };
      const auto is_met = [&](const passage& at) { return at.enter < at.leave - most && at.leave > most; };
      std::optional<exact_hit> wanted;
      bool sure = is_met(through(job, {{0, 0, 0}, m.n}, m.n));
      for (const cube& c : m.cubes) {
        const passage at = through(job, c, m.n);
        if (!may_be_met(at)) continue;
        sure = sure && is_met(at);
        if (!wanted || at.enter < wanted->at.enter) wanted = exact_hit{c, at};
      }
      ++rays;
      if (!sure) continue;
      CAPTURE(round, ray, m.n, text(job));
      const seen got = trace(p, job, m);
      REQUIRE(got.hit == wanted.has_value());
      if (!wanted) continue;
      ++clear;
      REQUIRE(got.where == wanted->where);
      const int128 enter = std::max<int128>(wanted->at.enter, 0), t = int128{got.t} * m.n;
      REQUIRE(t <= enter);
      REQUIRE(t >= enter - most);
      not_whole += enter % m.n != 0;
      lowered += t < enter - m.n / 2;
    }
  }
  CAPTURE(rays, clear, not_whole, lowered);
  CHECK(clear > 1'000);
  CHECK(not_whole > 200);
  CHECK(lowered > 50);
}

TEST_CASE("svo_core: through an edge or a corner a ray passes the planes in the order x, y, z, and enters the upper of two halves",
          "[svo_core]") {
  struct row {
    const char* name;
    per_axis<std::int64_t> t0, t1;     // of 2 voxels an edge
    std::vector<unsigned> on_the_way;  // numbers of the cubes that stop the ray, in order: bit 0 for x, 1 for y, 2 for z
    std::vector<std::int64_t> t;
    std::vector<int> axis;
  };
  const row table[] = {
      {"the corner in the middle", {8, 8, 8}, {24, 24, 24}, {0, 1, 3, 7}, {8, 16, 16, 16}, {0, 0, 0, 0}},
      {"the edge between x and y", {8, 8, 0}, {24, 24, 64}, {0, 1, 3}, {8, 16, 16}, {0, 0, 0}},
      {"the edge between y and z", {0, 8, 8}, {64, 24, 24}, {0, 2, 6}, {8, 16, 16}, {1, 1, 1}},
      {"the edge between x and z", {8, 0, 8}, {24, 64, 24}, {0, 1, 5}, {8, 16, 16}, {0, 0, 0}},
      {"in by x where y is halved", {16, 8, 0}, {48, 24, 64}, {2}, {16}, {0}},
      {"in by y where x is halved", {8, 16, 0}, {24, 48, 64}, {1}, {16}, {0}},
      {"in by z where y is halved", {0, 8, 16}, {64, 24, 48}, {2}, {16}, {1}},
      {"in by z where x and y are halved", {8, 8, 16}, {24, 24, 48}, {3}, {16}, {0}},
      {"in by the edge between y and z", {0, 16, 16}, {64, 48, 56}, {0, 1, 3, 7}, {16, 32, 32, 36}, {1, 0, 0, 2}},
  };
  for (const row& r : table)
    for (unsigned mirrored = 0; mirrored < 8; ++mirrored)
      for (unsigned child = 0; child < 8; ++child) {
        const unsigned slot = child ^ mirrored;
        const model m = model_of(2, {{static_cast<int>(slot & 1), static_cast<int>(slot >> 1 & 1), static_cast<int>(slot >> 2)}});
        const seen got = trace({}, job_of(mirrored, r.t0, r.t1), m);
        CAPTURE(r.name, mirrored, child);
        const auto stop = std::find(r.on_the_way.begin(), r.on_the_way.end(), child);
        REQUIRE(got.hit == (stop != r.on_the_way.end()));
        if (!got.hit) continue;
        const auto which = static_cast<std::size_t>(stop - r.on_the_way.begin());
        CHECK(got.t == r.t[which]);
        CHECK(got.axis == r.axis[which]);
        CHECK(got.sign == ((mirrored >> r.axis[which] & 1) != 0 ? 1 : -1));
      }
}

TEST_CASE("svo_core: what ends just where a ray starts is not ahead of it", "[svo_core]") {
  // Along x, through the quarter of y and z that is upper: x is halved at `start`, where cube 6 ends and cube 7 begins.
  const model lower = model_of(2, {{0, 1, 1}}), upper = model_of(2, {{1, 1, 1}});
  const auto ray = [](std::int64_t start) { return job_of(0, {start - 16, -100, -100}, {start + 16, 60, 60}); };
  struct row {
    std::int64_t start;
    bool lower, upper;
    std::int64_t lower_t, upper_t;
  };
  const row table[] = {
      {-17, false, false, 0, 0},  // all ends 1 behind the origin
      {-16, false, false, 0, 0},  // at it
      {-15, false, true, 0, 0},  {-1, false, true, 0, 0}, {0, false, true, 0, 0},  {1, true, true, 0, 1},
      {15, true, true, 0, 15},   {16, true, true, 0, 16}, {17, true, true, 1, 17},
  };
  for (const row& r : table) {
    CAPTURE(r.start);
    const seen low = trace({}, ray(r.start), lower), up = trace({}, ray(r.start), upper);
    // INIT and EVAL alone where nothing of the root is ahead.
    CHECK((up.cost == 2) == (r.start <= -16));
    CHECK(low.hit == r.lower);
    CHECK(up.hit == r.upper);
    CHECK(low.t == r.lower_t);
    CHECK(up.t == r.upper_t);
    CHECK(low.axis == (r.lower ? 0 : no_axis));
    CHECK(low.sign == (r.lower ? -1 : 0));
    CHECK(up.axis == (r.upper ? 0 : no_axis));
    CHECK(up.sign == (r.upper ? -1 : 0));
  }
  // The root cube is missed as well where the ray only touches it.
  CHECK_FALSE(trace({}, job_of(0, {64, 0, 0}, {128, 64, 256}), upper).hit);
  CHECK(trace({}, job_of(0, {62, 0, 0}, {128, 64, 64}), model_of(2, {{0, 1, 1}})).hit);
}

TEST_CASE("svo_core: the normal of a face looks to where the ray comes from, in the model's own axes", "[svo_core]") {
  // Voxel (1, 2, 1) of 4: from -0.5 to 0 along x and z, from 0 to 0.5 along y.
  const model m = model_of(4, {{1, 2, 1}});
  struct row {
    per_axis<double> origin, direction;
    int axis, sign;
    double t;  // in directions
  };
  const row table[] = {
      {{-3, 0.3, -0.3}, {1, 0, 0}, 0, -1, 2.5},
      {{3, 0.3, -0.3}, {-1, 0, 0}, 0, 1, 3},
      {{-0.3, -4, -0.2}, {0, 1, 0}, 1, -1, 4},
      {{-0.3, 4, -0.2}, {0, -1, 0}, 1, 1, 3.5},
      {{-0.2, 0.3, -2}, {0, 0, 1}, 2, -1, 1.5},
      {{-0.2, 0.3, 2}, {0, 0, -1}, 2, 1, 2},
      {{-0.75, 0.25, 0.125}, {0.5, 0.0625, -0.5}, 0, -1, 0.5},
      {{0.125, 0.25, -0.875}, {-0.5, -0.0625, 0.5}, 2, -1, 0.75},
      {{-0.25, 0.75, 0.125}, {0.125, -0.5, -0.5}, 1, 1, 0.5},
  };
  for (const row& r : table) {
    const job_packet packet = traversal_parameters(r.origin, r.direction, 9, {}, 0);
    traversal_job job;
    job.job_word = packet.job_word;
    numeric::float_to_fixed_stats stats;
    for (unsigned i = 0; i < 3; ++i) {
      job.t0[i] = numeric::float_to_fixed(packet.t0[i], {}, {}, stats);
      job.t1[i] = numeric::float_to_fixed(packet.t1[i], {}, {}, stats);
    }
    CAPTURE(text(job));
    const seen got = trace({}, job, m);
    REQUIRE(got.hit);
    CHECK(got.axis == r.axis);
    CHECK(got.sign == r.sign);
    // The driver makes directions 1 long.
    const double t = r.t * std::hypot(r.direction[0], r.direction[1], r.direction[2]);
    CHECK(std::abs(static_cast<double>(got.t) - t * 65536) <= 2);
  }
}

}  // namespace rtusim
