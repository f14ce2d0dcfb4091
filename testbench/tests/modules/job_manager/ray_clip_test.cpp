#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <vector>

#include "modules/job_manager/ray_setup.h"
#include "testbench/kinds/driver.h"
#include "testbench/tests/random.h"

/// Where rays enter the scene's box, and whether, against the slabs' distances as ratios of whole numbers, compared without a division.
namespace rtusim {
namespace {

__extension__ using int128 = __int128;
using whole_point = per_axis<std::int64_t>;

struct ratio {
  int128 above = 0, below = 1;  // below > 0
};
bool operator<(const ratio& a, const ratio& b) { return a.above * b.below < b.above * a.below; }

/// The greatest whole number that is not above `r` times 2^`up`, r >= 0.
int128 floor_of(const ratio& r, unsigned up) { return (r.above << up) / r.below; }

struct slabs {
  bool beside = false;  // parallel to a slab, outside of it
  bool within = true;   // starts in the box or on its faces
  ratio enter{0, 1}, leave{1, 0};

  /// In directions, of which the greatest word's is nearly 1 long.
  slabs(const whole_point& from, const whole_point& along, const whole_point& corner) {
    for (unsigned i = 0; i < 3; ++i) {
      within = within && from[i] >= 0 && from[i] <= corner[i];
      if (along[i] == 0) {
        beside = beside || from[i] < 0 || from[i] > corner[i];
        continue;
      }
      const bool up = along[i] > 0;
      const int128 step = up ? along[i] : -along[i], to_lower = -int128{from[i]}, to_upper = int128{corner[i]} - from[i];
      const ratio near{up ? to_lower : -to_upper, step}, far{up ? to_upper : -to_lower, step};
      enter = std::max(enter, near);
      leave = std::min(leave, far);
    }
  }
  bool meets() const { return !beside && !(leave < enter); }
};

std::uint32_t binary32_bits(double value) {
  const auto exact = static_cast<float>(value);
  REQUIRE(static_cast<double>(exact) == value);
  std::uint32_t bits;
  std::memcpy(&bits, &exact, sizeof bits);
  return bits;
}

job_packet packet_of(const whole_point& from, const whole_point& along, const quantisation& q) {
  job_packet p;
  p.job_word = 3;
  for (unsigned i = 0; i < 3; ++i) {
    p.t0[i] = binary32_bits(std::ldexp(static_cast<double>(from[i]), -static_cast<int>(q.n)));
    p.t1[i] = binary32_bits(std::ldexp(static_cast<double>(along[i]), 1 - static_cast<int>(q.m)));
  }
  return p;
}

enum kind : unsigned { anywhere, inside, on_a_face, on_an_edge, just_outside, past, kinds };

std::int64_t between(test::rng& random, std::int64_t least, std::int64_t most) {
  return least + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most - least + 1));
}

}  // namespace

TEST_CASE("ray_setup: rays enter the box, miss it or stay where they are as exact slabs tell", "[job_manager]") {
  test::rng random(307);
  // Words of at most 24 bits, so that the packets' floats are exact, times a power of two.
  struct widths {
    quantisation q;
    unsigned origin_up, direction_up;
  };
  const widths designs[] = {{{8, 10, 4, 4, 0}, 0, 0}, {{16, 20, 4, 12, 0}, 0, 0}, {{20, 24, 6, 16, 0}, 0, 0}, {{}, 12, 8}};
  unsigned of_kind[kinds] = {}, clipped = 0, missed = 0, at_the_last_unit = 0;
  for (unsigned round = 0; round < 200; ++round) {
    const widths& w = designs[round % 4];
    const quantisation& q = w.q;
    const std::int64_t grid = q.greatest_coordinate() >> w.origin_up, one = std::int64_t{1} << (q.m - 1 - w.direction_up);
    whole_point corner;
    for (std::int64_t& c : corner) c = between(random, 1, grid) << w.origin_up;
    corner[random() % 3] = grid << w.origin_up;
    const ray_setup setup(q, corner);
    for (unsigned ray = 0; ray < 400; ++ray) {
      const auto how = static_cast<kind>(random() % kinds);
      whole_point from, along;
      for (unsigned i = 0; i < 3; ++i) {
        const std::int64_t side = corner[i] >> w.origin_up;
        from[i] = between(random, 0, side);
        if (how == anywhere) from[i] = between(random, -3 * side, 4 * side);
        along[i] = random() % 8 == 0 ? 0 : between(random, 1 - one, one - 1) >> random() % 4;
        // Toward the box, mostly.
        if (how == anywhere && random() % 4 != 0) along[i] = std::clamp<std::int64_t>(between(random, 0, side) - from[i], 1 - one, one - 1);
      }
      const unsigned axis = random() % 3, other = (axis + 1 + random() % 2) % 3;
      const auto last = [&](unsigned i) { return corner[i] >> w.origin_up; };
      if (how == on_a_face || how == on_an_edge) from[axis] = random() % 2 == 0 ? 0 : last(axis);
      if (how == on_an_edge) from[other] = random() % 2 == 0 ? 0 : last(other);
      if (how == just_outside) from[axis] = random() % 2 == 0 ? -1 : last(axis) + 1;
      if (how == past) {
        const bool up = random() % 2 == 0;
        from[axis] = up ? last(axis) + between(random, 1, 50) : -between(random, 1, 50);
        along[axis] = up ? std::abs(along[axis]) : -std::abs(along[axis]);
      }
      for (unsigned i = 0; i < 3; ++i) {
        from[i] *= std::int64_t{1} << w.origin_up;
        along[i] *= std::int64_t{1} << w.direction_up;
      }
      ray_setup_stats stats;
      triangle_job job;
      setup(packet_of(from, along, q), stats, job);
      CAPTURE(round, ray, static_cast<int>(how), q.n, from[0], from[1], from[2], along[0], along[1], along[2], corner[0], corner[1],
              corner[2]);
      REQUIRE(job.ray.direction == along);
      const slabs exact(from, along, corner);
      const bool misses = job.ray.misses_box;
      ++of_kind[how];
      missed += misses;
      REQUIRE(stats.missed_box == (misses ? 1 : 0));
      if (exact.within) {
        REQUIRE_FALSE(misses);
        REQUIRE(stats.clipped == 0);
        REQUIRE(job.ray.position == from);
        continue;
      }
      if (how == past) REQUIRE(misses);
      // No ray that meets the box is lost, and none that passes it by a grid unit of its way or more is kept.
      if (exact.meets()) REQUIRE_FALSE(misses);
      const unsigned up = q.m - 1;
      const bool by_a_unit = exact.beside || exact.leave.above < 0 || floor_of(exact.enter, up) > floor_of(exact.leave, up);
      REQUIRE(misses == by_a_unit);
      at_the_last_unit += !exact.meets() && !misses;
      if (misses) continue;
      const int128 enter = floor_of(exact.enter, up);
      REQUIRE(stats.clipped == (enter > 0 ? 1 : 0));
      clipped += enter > 0;
      for (unsigned i = 0; i < 3; ++i) {
        const std::int64_t position = job.ray.position[i];
        // The way is cut to a grid unit, and what it comes to along an axis is rounded down.
        const int128 unit = int128{1} << up;
        const int128 moved = enter * along[i];
        const int128 wanted = from[i] + (moved >= 0 ? moved / unit : -((-moved + unit - 1) / unit));
        REQUIRE(position == static_cast<std::int64_t>(std::clamp<int128>(wanted, 0, corner[i])));
        const double at = static_cast<double>(from[i]) +
                          static_cast<double>(exact.enter.above) / static_cast<double>(exact.enter.below) * static_cast<double>(along[i]);
        if (exact.meets()) REQUIRE(std::fabs(static_cast<double>(position) - at) < 2.001);
      }
    }
  }
  CAPTURE(clipped, missed, at_the_last_unit);
  for (const unsigned count : of_kind) CHECK(count > 10'000);
  CHECK(clipped > 5'000);
  CHECK(missed > 15'000);
  CHECK(at_the_last_unit > 0);
}

TEST_CASE("driver: exactly the rays that meet the box from where they start on are sent to triangle cores", "[job_manager]") {
  test::rng random(308);
  const whole_point corner{16, 8, 5};
  // Grid units as world units; the origins' words are 2^-10 of them.
  const grid_mapping grid{1, {3, 2, 1}, {16, 8, 5}, 10};
  std::vector<ray_list::ray> rays;
  std::set<std::uint32_t> wanted;
  unsigned touching = 0, behind = 0;
  for (std::uint32_t id = 0; id < 20'000; ++id) {
    whole_point from, along;
    ray_list::ray& r = rays.emplace_back();
    for (unsigned i = 0; i < 3; ++i) {
      from[i] = between(random, -6, corner[i] + 6);
      along[i] = between(random, -3, 3);
    }
    if (along == whole_point{}) along[0] = 1;
    for (unsigned i = 0; i < 3; ++i) {
      r.origin[i] = static_cast<float>(from[i]) - static_cast<float>(grid.centre[i]);
      r.direction[i] = static_cast<float>(along[i]);
    }
    const slabs exact(from, along, corner), back(from, {-along[0], -along[1], -along[2]}, corner);
    if (exact.meets()) wanted.insert(id);
    touching += exact.meets() && !(exact.enter < exact.leave);
    behind += !exact.meets() && back.meets();
  }
  CHECK(touching > 500);
  CHECK(behind > 500);
  const ray_list list(rays);
  for (const direction_norm norm : {direction_norm::one, direction_norm::two}) {
    std::set<std::uint32_t> sent;
    for (const job_packet& job : triangle_jobs(list, grid, norm, true)) sent.insert(job.job_word);
    CHECK(sent == wanted);
    const auto all = triangle_jobs(list, grid, norm, false);
    CHECK(all.size() == rays.size());
    for (std::uint32_t id = 0; id < all.size(); ++id)
      if (all[id].job_word != id) FAIL("ray " << id << " is job " << all[id].job_word);
  }
  // The words of one: the origin in 2^10 grid units, a direction of (3, 0, -1) over 4.
  const auto one = triangle_jobs(ray_list(std::vector<ray_list::ray>{{{1, -2, 4}, {3, 0, -1}}}), grid, direction_norm::one, true);
  REQUIRE(one.size() == 1);
  CHECK(one[0].t0 == per_axis<std::uint32_t>{binary32_bits(4.0 / 1024), 0, binary32_bits(5.0 / 1024)});
  CHECK(one[0].t1 == per_axis<std::uint32_t>{binary32_bits(0.75), 0, binary32_bits(-0.25)});
}

}  // namespace rtusim
