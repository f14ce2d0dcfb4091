#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_machine.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/svo_builder.h"
#include "testbench/driver.h"
#include "testbench/tests/random.h"

/// Rays against every filled cube of a small octree, in whole numbers: no descent, no midpoints, no stack.
///
/// Plane k of n along an axis lies at t0 + (t1 - t0) k / n, in the ray's own direction; where the ray is mirrored on the axis, it is the
/// model's plane n - k. The core finds its planes by halving, rounded down; where t1 - t0 is a multiple of n that is exact, and so is
/// every comparison with it.
namespace rtusim {
namespace {

__extension__ using int128 = __int128;

struct cube {
  per_axis<int> low{};  // in finest voxels
  int size = 1;
};
bool operator==(const cube& a, const cube& b) { return a.low == b.low && a.size == b.size; }

struct model {
  int n = 2;                // finest voxels an edge
  std::vector<cube> cubes;  // filled, each as large as it can be, but never the root
  svo_image image;

  word_view words() const { return {image.words.data(), static_cast<std::uint32_t>(image.words.size()), (1u << 20) - 1}; }
};

model model_of(int n, const std::vector<per_axis<int>>& filled) {
  model m;
  m.n = n;
  voxel_grid grid(static_cast<unsigned>(n));
  const auto u = [](int v) { return static_cast<unsigned>(v); };
  for (const auto& v : filled) grid.fill(u(v[0]), u(v[1]), u(v[2]));
  m.image = build_svo(grid, "voxels");
  const auto covered = [&](const per_axis<int>& v) {
    return std::any_of(m.cubes.begin(), m.cubes.end(), [&](const cube& c) {
      for (unsigned i = 0; i < 3; ++i)
        if (v[i] < c.low[i] || v[i] >= c.low[i] + c.size) return false;
      return true;
    });
  };
  for (int size = n / 2; size > 0; size /= 2)
    for (int x = 0; x < n; x += size)
      for (int y = 0; y < n; y += size)
        for (int z = 0; z < n; z += size) {
          if (covered({x, y, z})) continue;
          bool full = true;
          for (int dx = 0; dx < size; ++dx)
            for (int dy = 0; dy < size; ++dy)
              for (int dz = 0; dz < size; ++dz) full = full && grid.at(u(x + dx), u(y + dy), u(z + dz));
          if (full) m.cubes.push_back({{x, y, z}, size});
        }
  return m;
}

/// Where a ray enters and leaves a cube; distances times n.
struct passage {
  int128 enter = 0, leave = 0;
  int axis = 0;  // of the last plane that is passed on the way in; of equals x before y before z
  int sign = 0;  // of the normal of the face there
};

passage through(const traversal_job& job, const cube& c, int n) {
  passage p;
  for (unsigned i = 0; i < 3; ++i) {
    const bool mirrored = job.direction_bits() >> i & 1;
    const int first = mirrored ? n - (c.low[i] + c.size) : c.low[i];
    const auto plane = [&](int k) { return int128{job.t0[i]} * n + (int128{job.t1[i]} - job.t0[i]) * k; };
    if (i == 0 || plane(first) > p.enter) {
      p.enter = plane(first);
      p.axis = static_cast<int>(i);
      p.sign = mirrored ? 1 : -1;  // in by the cube's upper face, or by its lower
    }
    p.leave = i == 0 ? plane(first + c.size) : std::min(p.leave, plane(first + c.size));
  }
  return p;
}

struct exact_hit {
  cube where;
  passage at;
};

/// The nearest cube of which the ray meets more than an edge or a corner, ahead of its origin, or, with `behind`, anywhere.
/// `touches`: the ray meets an edge or a corner of a filled cube, and no more of it, before that.
std::optional<exact_hit> nearest(const traversal_job& job, const model& m, bool behind, bool& touches) {
  std::optional<exact_hit> best;
  for (const cube& c : m.cubes) {
    const passage p = through(job, c, m.n);
    if (p.enter < p.leave && (behind || p.leave > 0) && (!best || p.enter < best->at.enter)) best = exact_hit{c, p};
  }
  touches = std::any_of(m.cubes.begin(), m.cubes.end(), [&](const cube& c) {
    const passage p = through(job, c, m.n);
    return p.enter == p.leave && (behind || p.leave > 0) && (!best || p.enter <= best->at.enter);
  });
  return best;
}

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

traversal_job job_of(unsigned mirrored, const per_axis<std::int64_t>& t0, const per_axis<std::int64_t>& t1) {
  traversal_job job;
  job.job_word = mirrored << job_id_bits | 5;
  job.t0 = t0;
  job.t1 = t1;
  return job;
}

model random_model(test::rng& random) {
  const int n = 2 << random() % 3;
  const unsigned empty = 1 + random() % 12;  // of 16
  std::vector<per_axis<int>> filled;
  while (filled.empty())
    for (int x = 0; x < n; ++x)
      for (int y = 0; y < n; ++y)
        for (int z = 0; z < n; ++z)
          if (random() % 16 >= empty) filled.push_back({x, y, z});
  return model_of(n, filled);
}

std::int64_t below(test::rng& random, std::int64_t end) {
  return static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) % static_cast<std::uint64_t>(end));
}

/// Slabs that overlap, of about 2^`bits` words, planes apart by a multiple of `step`.
traversal_job random_slabs(test::rng& random, unsigned bits, std::int64_t step) {
  per_axis<std::int64_t> t0, t1;
  const std::int64_t size = std::int64_t{1} << bits;
  for (unsigned i = 0; i < 3; ++i) {
    t0[i] = below(random, size) - size / 2;
    t1[i] = t0[i] + step * (1 + below(random, size >> random() % 3));
  }
  return job_of(random() % 8, t0, t1);
}

/// The ray moved along itself, so that it starts at distance `start` of what it was.
void start_at(traversal_job& job, std::int64_t start) {
  for (unsigned i = 0; i < 3; ++i) {
    job.t0[i] -= start;
    job.t1[i] -= start;
  }
}

bool fits(const traversal_job& job, const numeric::fixed_format& f) {
  for (unsigned i = 0; i < 3; ++i)
    if (std::min(job.t0[i], job.t1[i]) < f.least() || std::max(job.t0[i], job.t1[i]) > f.greatest()) return false;
  return true;
}

std::string text(const traversal_job& job) {
  std::string s = fmt::format("mirrored {}:", job.direction_bits());
  for (unsigned i = 0; i < 3; ++i) s += fmt::format(" {}..{}", job.t0[i], job.t1[i]);
  return s;
}

enum start : unsigned { as_it_is, in_a_cube, on_a_plane, at_the_end, behind_all, near_the_greatest_word, starts };

/// Moves a ray to where it starts within a filled cube, on one's face, at or behind the model's end, or to words near the format's end.
void move(test::rng& random, traversal_job& job, const model& m, start how, const numeric::fixed_format& f) {
  const passage root = through(job, {{0, 0, 0}, m.n}, m.n);
  const passage p = through(job, m.cubes[random() % m.cubes.size()], m.n);
  const auto word = [&](int128 scaled) { return static_cast<std::int64_t>(scaled / m.n); };
  switch (how) {
    case in_a_cube: start_at(job, word(p.enter) + (p.leave > p.enter ? below(random, word(p.leave - p.enter) + 1) : 0)); break;
    case on_a_plane: start_at(job, word(random() % 2 == 0 ? p.enter : p.leave)); break;
    case at_the_end: start_at(job, word(root.leave) + static_cast<std::int64_t>(random() % 3) - 1); break;
    case behind_all: start_at(job, word(root.leave) + below(random, 1000)); break;
    case near_the_greatest_word: start_at(job, *std::max_element(job.t1.begin(), job.t1.end()) - f.greatest()); break;
    default: break;
  }
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

TEST_CASE("svo_core: the erratum negative_t finds the nearest cube of the whole line, positive_normals turns every normal up", "[svo_core]") {
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
    per_axis<std::int64_t> t0, t1;  // of 2 voxels an edge
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
      {-15, false, true, 0, 0},
      {-1, false, true, 0, 0},
      {0, false, true, 0, 0},
      {1, true, true, 0, 1},
      {15, true, true, 0, 15},
      {16, true, true, 0, 16},
      {17, true, true, 1, 17},
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
      {{-3, 0.3, -0.3}, {1, 0, 0}, 0, -1, 2.5}, {{3, 0.3, -0.3}, {-1, 0, 0}, 0, 1, 3},
      {{-0.3, -4, -0.2}, {0, 1, 0}, 1, -1, 4},  {{-0.3, 4, -0.2}, {0, -1, 0}, 1, 1, 3.5},
      {{-0.2, 0.3, -2}, {0, 0, 1}, 2, -1, 1.5}, {{-0.2, 0.3, 2}, {0, 0, -1}, 2, 1, 2},
      {{-0.75, 0.25, 0.125}, {0.5, 0.0625, -0.5}, 0, -1, 0.5}, {{0.125, 0.25, -0.875}, {-0.5, -0.0625, 0.5}, 2, -1, 0.75},
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
