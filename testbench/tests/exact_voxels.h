#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/formats/packets.h"
#include "modules/formats/svo_image.h"
#include "modules/formats/word_view.h"
#include "modules/numeric/fixed_point.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxel_grid.h"
#include "testbench/tests/random.h"

/// Rays against every filled cube of a small octree, in whole numbers: no descent, no midpoints, no stack.
///
/// Plane k of n along an axis lies at t0 + (t1 - t0) k / n, in the ray's own direction; where the ray is mirrored on the axis, it is the
/// model's plane n - k. The core finds its planes by halving, rounded down; where t1 - t0 is a multiple of n that is exact, and so is
/// every comparison with it.
namespace rtusim::test {

__extension__ using int128 = __int128;

struct cube {
  per_axis<int> low{};  // in finest voxels
  int size = 1;
};
inline bool operator==(const cube& a, const cube& b) { return a.low == b.low && a.size == b.size; }

struct model {
  int n = 2;                // finest voxels an edge
  std::vector<cube> cubes;  // filled, each as large as it can be, but never the root
  svo_image image;

  word_view words() const { return {image.words.data(), static_cast<std::uint32_t>(image.words.size()), (1u << 20) - 1}; }
};

inline model model_of(int n, const std::vector<per_axis<int>>& filled) {
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

inline passage through(const traversal_job& job, const cube& c, int n) {
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
inline std::optional<exact_hit> nearest(const traversal_job& job, const model& m, bool behind, bool& touches) {
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

inline traversal_job job_of(unsigned mirrored, const per_axis<std::int64_t>& t0, const per_axis<std::int64_t>& t1) {
  traversal_job job;
  job.job_word = mirrored << job_id_bits | 5;
  job.t0 = t0;
  job.t1 = t1;
  return job;
}

inline model random_model(rng& random) {
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

inline std::int64_t below(rng& random, std::int64_t end) {
  return static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) % static_cast<std::uint64_t>(end));
}

/// Slabs that overlap, of about 2^`bits` words, planes apart by a multiple of `step`.
inline traversal_job random_slabs(rng& random, unsigned bits, std::int64_t step) {
  per_axis<std::int64_t> t0, t1;
  const std::int64_t size = std::int64_t{1} << bits;
  for (unsigned i = 0; i < 3; ++i) {
    t0[i] = below(random, size) - size / 2;
    t1[i] = t0[i] + step * (1 + below(random, size >> random() % 3));
  }
  return job_of(random() % 8, t0, t1);
}

/// The ray moved along itself, so that it starts at distance `start` of what it was.
inline void start_at(traversal_job& job, std::int64_t start) {
  for (unsigned i = 0; i < 3; ++i) {
    job.t0[i] -= start;
    job.t1[i] -= start;
  }
}

inline bool fits(const traversal_job& job, const numeric::fixed_format& f) {
  for (unsigned i = 0; i < 3; ++i)
    if (std::min(job.t0[i], job.t1[i]) < f.least() || std::max(job.t0[i], job.t1[i]) > f.greatest()) return false;
  return true;
}

inline std::string text(const traversal_job& job) {
  std::string s = fmt::format("mirrored {}:", job.direction_bits());
  for (unsigned i = 0; i < 3; ++i) s += fmt::format(" {}..{}", job.t0[i], job.t1[i]);
  return s;
}

enum start : unsigned { as_it_is, in_a_cube, on_a_plane, at_the_end, behind_all, near_the_greatest_word, starts };

/// Moves a ray to where it starts within a filled cube, on one's face, at or behind the model's end, or to words near the format's end.
inline void move(rng& random, traversal_job& job, const model& m, start how, const numeric::fixed_format& f) {
  const passage root = through(job, {{0, 0, 0}, m.n}, m.n);
  const passage p = through(job, m.cubes[random() % m.cubes.size()], m.n);
  const auto word = [&](int128 scaled) { return static_cast<std::int64_t>(scaled / m.n); };
  switch (how) {
    case in_a_cube: start_at(job, word(p.enter) + (p.leave > p.enter ? below(random, word(p.leave - p.enter) + 1) : 0)); break;
    case on_a_plane: start_at(job, word(random() % 2 == 0 ? p.enter : p.leave)); break;
    case at_the_end: start_at(job, word(root.leave) + static_cast<std::int64_t>(random() % 3) - 1); break;
    case behind_all: start_at(job, word(root.leave) + below(random, 1000)); break;
    case near_the_greatest_word: {
      const std::int64_t greatest = std::min(f.greatest(), std::int64_t{1} << 61);  // beyond that the test's own words would wrap
      start_at(job, *std::max_element(job.t1.begin(), job.t1.end()) - greatest);
      break;
    }
    case as_it_is:
    case starts: break;
  }
}

}  // namespace rtusim::test
