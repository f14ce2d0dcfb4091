#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "modules/bih_core/bih_kind.h"
#include "scenes/meshes/mesh.h"
#include "scenes/scene.h"
#include "scenes/triangles/bih_builder.h"
#include "scenes/triangles/quantised_triangles.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/bih_host.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random.h"

/// Whole designs without errata against corners on the grid: whether a ray meets a triangle is told by the signs of three volumes in
/// whole numbers, ahead or behind by a fourth. Only how far the hardware's roundings reach is a real number; where a ray passes an edge by
/// less than that, both answers are right.
namespace rtusim {
namespace {

__extension__ using int128 = __int128;
using real = long double;
using corners = std::array<grid_point, 3>;

struct triangle_scene {
  bih_memory memory;
  std::vector<corners> triangles;
  std::vector<bool> clamped;
};

/// A hierarchy over corners on the grid; what has no area is left out.
triangle_scene scene_of(const std::vector<corners>& all, const quantisation& q, unsigned leaf_triangles, unsigned address_bits) {
  triangle_scene s;
  std::vector<accelerated_triangle> accelerated;
  std::vector<triangle_box> boxes;
  for (const corners& c : all) {
    bool clamped = false;
    const auto a = accelerate(c, q, clamped);
    if (!a) continue;
    s.triangles.push_back(c);
    s.clamped.push_back(clamped);
    accelerated.push_back(*a);
    triangle_box& box = boxes.emplace_back();
    for (unsigned i = 0; i < 3; ++i) std::tie(box.lower[i], box.upper[i]) = std::minmax({c[0][i], c[1][i], c[2][i]});
  }
  s.memory = build_bih(boxes, leaf_triangles, address_bits, "corners");
  s.memory.triangles = accelerated;
  return s;
}

std::uint32_t binary32_bits(double value) {
  const auto rounded = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return bits;
}

/// A binary32 times 2^`up`, cut to a whole number.
std::int64_t whole(std::uint32_t bits, unsigned up) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<std::int64_t>(std::ldexp(static_cast<double>(value), static_cast<int>(up)));
}

struct line {
  grid_point from{}, along{};  // grid units; 2^(m-1) grid units of distance

  line(const job_packet& job, const quantisation& q) {
    for (unsigned i = 0; i < 3; ++i) {
      from[i] = whole(job.t0[i], q.n);
      along[i] = std::clamp(whole(job.t1[i], q.m - 1), -q.greatest_direction(), q.greatest_direction());
    }
  }
};

int128 volume(const grid_point& d, const grid_point& a, const grid_point& b) {
  return int128{d[0]} * (int128{a[1]} * b[2] - int128{a[2]} * b[1]) + int128{d[1]} * (int128{a[2]} * b[0] - int128{a[0]} * b[2]) +
         int128{d[2]} * (int128{a[0]} * b[1] - int128{a[1]} * b[0]);
}

grid_point difference(const grid_point& a, const grid_point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// A ray against a triangle, and by how much the hardware may be off.
struct meeting {
  bool ahead = false;         // the plane, of a ray that is not parallel
  real share[3] = {};         // barycentric coordinates
  real t = 0, t_off = 0;      // grid units from the ray's origin
  real u_off = 0, v_off = 0;  // of the coordinates of vertices 2 and 1
  bool surely = false, maybe = false;
};

meeting meet(const line& l, const corners& c, const quantisation& q, bool clipped) {
  meeting m;
  const grid_point v[3] = {difference(c[0], l.from), difference(c[1], l.from), difference(c[2], l.from)};
  const int128 whole_volume[3] = {volume(l.along, v[1], v[2]), volume(l.along, v[2], v[0]), volume(l.along, v[0], v[1])};
  const int128 sum = whole_volume[0] + whole_volume[1] + whole_volume[2];
  const int128 away = volume(v[0], v[1], v[2]);
  if (sum == 0) return m;
  m.ahead = away != 0 && (away > 0) == (sum > 0);
  const real one = std::ldexp(real{1}, static_cast<int>(q.m) - 1);
  for (unsigned i = 0; i < 3; ++i) m.share[i] = static_cast<real>(whole_volume[i]) / static_cast<real>(sum);
  m.t = static_cast<real>(away) / static_cast<real>(sum) * one;

  // The normal's longest component, r, and by how much of it a step along the ray nears the plane.
  const grid_point e1 = difference(c[1], c[0]), e2 = difference(c[2], c[0]);
  real normal[3];
  unsigned r = 0;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
    normal[i] = static_cast<real>(int128{e1[j]} * e2[k] - int128{e1[k]} * e2[j]);
    if (std::fabs(normal[i]) > std::fabs(normal[r])) r = i;
  }
  const real slope = std::fabs(static_cast<real>(sum) / normal[r] / one);
  // d is rounded by 1/2, its products with the position by 1 each, n_p and n_q by 2^-m; the denominator's products by 2^(1-m) each, over a
  // way of less than 2^(n+1). A ray that is moved to the box stands beside itself by less than 2 on each axis, and 1 along it.
  const real words = std::ldexp(real{1}, static_cast<int>(q.n) - static_cast<int>(q.m));
  m.t_off = 1 + (real{2.5} + 14 * words + (clipped ? 6 : 0)) / slope + (clipped ? 1 : 0);
  const real k_off = m.t_off + 2 + (clipped ? 2 : 0);
  real k = 0;
  for (unsigned i = 0; i < 3; ++i)
    if (i != r) k += std::fabs(static_cast<real>(l.from[i] - c[0][i]) + m.t * static_cast<real>(l.along[i]) / one);
  const real last_edge_bit = std::ldexp(real{1}, 1 - static_cast<int>(q.m + q.edge_shift));
  const auto off = [&](const grid_point& edge) {
    real length = 0;
    for (unsigned i = 0; i < 3; ++i)
      if (i != r) length += std::fabs(static_cast<real>(edge[i]) / normal[r]);
    return k_off * length + last_edge_bit / 2 * (k + 2 * k_off);
  };
  m.u_off = off(e1);
  m.v_off = off(e2);
  const real to_zero = m.u_off + m.v_off;
  const bool far_enough = m.t > m.t_off;
  m.surely = m.ahead && far_enough && m.share[0] > to_zero && m.share[1] > m.v_off && m.share[2] > m.u_off;
  m.maybe = (m.ahead || std::fabs(m.t) <= m.t_off) && m.share[0] >= -to_zero && m.share[1] >= -m.v_off && m.share[2] >= -m.u_off;
  return m;
}

/// Where a ray enters the box, 0 from within it; `meets` where it does.
real entry(const line& l, const per_axis<std::int64_t>& corner, const quantisation& q, bool& meets) {
  real enter = 0, leave = INFINITY;
  for (unsigned i = 0; i < 3; ++i) {
    if (l.along[i] == 0) {
      if (l.from[i] < 0 || l.from[i] > corner[i]) leave = -1;
      continue;
    }
    const real low = -static_cast<real>(l.from[i]) / static_cast<real>(l.along[i]);
    const real high = static_cast<real>(corner[i] - l.from[i]) / static_cast<real>(l.along[i]);
    enter = std::max(enter, std::min(low, high));
    leave = std::min(leave, std::max(low, high));
  }
  meets = enter <= leave;
  return std::ldexp(enter, static_cast<int>(q.m) - 1);
}

/// Results by job word.
std::vector<mesh_result> simulate(const design& d, const bih_memory& memory, const std::vector<job_packet>& jobs, pace p) {
  std::istringstream log(in_child([&] {
    const surroundings s;
    simulation sim(d, s, bih_contents(memory), jobs, p);
    std::string text;
    sim.board().on_result([&](cycle, const traversal_result& any, std::uint64_t) {
      const auto& r = static_cast<const mesh_result&>(any);
      text += fmt::format("{} {} {} {} {} {}\n", r.job_word, static_cast<int>(r.hit), r.triangle, r.t_hit, r.u, r.v);
    });
    sim.run();
    return text;
  }));
  std::vector<mesh_result> results(jobs.size());
  std::size_t count = 0;
  for (mesh_result r; log >> r.job_word >> r.hit >> r.triangle >> r.t_hit >> r.u >> r.v; ++count) results.at(r.job_word) = r;
  REQUIRE(count == jobs.size());
  return results;
}

struct tally {
  unsigned hits = 0, misses = 0, unclear = 0, lost = 0, behind = 0, clipped = 0;
  real greatest_error = 0;  // of t, of rays from within the box, at planes that a step nears by no less than half of it
};

/// Holds results against the exact test. `lost` counts rays that the hierarchy kept from a triangle that they surely meet.
void compare(const design& d, const triangle_scene& s, const std::vector<job_packet>& jobs, const std::vector<mesh_result>& results,
             tally& sums) {
  const quantisation& q = d.of<bih_kind>().words;
  const real one = std::ldexp(real{1}, static_cast<int>(q.m) - 1);
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    const mesh_result& got = results[j];
    const line l(jobs[j], q);
    bool meets_box = false;
    const real enter = entry(l, s.memory.corner, q, meets_box);
    const bool clipped = enter > 0;
    bool some_behind = false, some_maybe = false, sure = false;
    real nearest = INFINITY;  // the greatest distance that the nearest sure hit may have
    for (std::size_t k = 0; k < s.triangles.size(); ++k) {
      const meeting m = meet(l, s.triangles[k], q, clipped);
      const bool known = m.surely && !s.clamped[k];
      some_maybe |= m.maybe;
      some_behind |= !m.ahead && m.share[0] > 0 && m.share[1] > 0 && m.share[2] > 0;
      sure |= known;
      if (known) nearest = std::min(nearest, m.t - enter + m.t_off);
    }
    CAPTURE(j, l.from[0], l.from[1], l.from[2], l.along[0], l.along[1], l.along[2], got.hit, got.triangle, got.t_hit);
    sums.unclear += some_maybe && !sure;
    sums.behind += some_behind && !some_maybe;
    if (!got.hit) {
      if (got.t_hit != 0 || got.u != 0 || got.v != 0 || got.triangle != 0) FAIL("a miss that carries words");
      sums.lost += sure;
      ++sums.misses;
      continue;
    }
    REQUIRE(meets_box);
    const meeting m = meet(l, s.triangles.at(got.triangle), q, clipped);
    REQUIRE((m.maybe || s.clamped[got.triangle]));
    const real error = std::fabs(static_cast<real>(got.t_hit) - (m.t - enter));
    CAPTURE(m.t, m.t_off, enter);
    REQUIRE(error <= m.t_off);
    if (!clipped && m.t_off <= 13) sums.greatest_error = std::max(sums.greatest_error, error);
    if (!s.clamped[got.triangle]) {
      REQUIRE(got.u >= 0);
      REQUIRE(got.v >= 0);
      REQUIRE(std::fabs(static_cast<real>(got.u) / one - m.share[2]) <= m.u_off + 1 / one);
      REQUIRE(std::fabs(static_cast<real>(got.v) / one - m.share[1]) <= m.v_off + 1 / one);
    }
    sums.lost += static_cast<real>(got.t_hit) > nearest;
    sums.clipped += clipped;
    ++sums.hits;
  }
}

std::int64_t below(test::rng& random, std::int64_t end) {
  return static_cast<std::int64_t>((std::uint64_t{random()} << 32 | random()) % static_cast<std::uint64_t>(end));
}

/// Triangles of any size in a box, none so thin that its edges would be clamped.
std::vector<corners> random_corners(test::rng& random, const quantisation& q, unsigned count) {
  std::vector<corners> all;
  const per_axis<std::int64_t> sides{q.greatest_coordinate(), q.greatest_coordinate() / 2, q.greatest_coordinate() / 3};
  const unsigned spread = random() % 4;
  while (all.size() < count) {
    corners c;
    for (unsigned i = 0; i < 3; ++i) {
      c[0][i] = below(random, sides[i] + 1);
      for (unsigned k = 1; k < 3; ++k)
        c[k][i] = std::clamp<std::int64_t>(c[0][i] + ((below(random, 2 * sides[i] + 1) - sides[i]) >> spread), 0, sides[i]);
    }
    bool clamped = false;
    if (accelerate(c, q, clamped) && !clamped) all.push_back(c);
  }
  return all;
}

/// A ray whose words are the floats': from within the box, outside of it or a corner of a triangle, at a triangle or away from it.
job_packet random_ray(test::rng& random, const std::vector<corners>& all, const quantisation& q, std::uint32_t id) {
  job_packet p;
  p.job_word = id;
  const corners& at = all[random() % all.size()];
  const unsigned from = random() % 4;
  double d[3], most = 0;
  const double weights[3] = {random() % 1000 / 1000.0, random() % 1000 / 1000.0, 0.1};
  const bool away = random() % 4 == 0, at_a_triangle = random() % 4 != 0;
  for (unsigned i = 0; i < 3; ++i) {
    const double side = std::ldexp(1.0, static_cast<int>(q.n));
    double o = static_cast<double>(below(random, q.greatest_coordinate())) / (i + 1);
    if (from == 1) o = 4 * o - 1.5 * side / (i + 1);
    if (from == 2) o = static_cast<double>(at[random() % 3][i]);
    p.t0[i] = binary32_bits(o / side);
    d[i] = -o;
    for (unsigned k = 0; k < 3; ++k) d[i] += weights[k] / (weights[0] + weights[1] + weights[2]) * static_cast<double>(at[k][i]);
    if (!at_a_triangle) d[i] = static_cast<double>(random() % 2001) - 1000;
    if (away) d[i] = -d[i];
    if (random() % 16 == 0) d[i] = 0;
    most = std::max(most, std::fabs(d[i]));
  }
  const double length = 0.65 + random() % 1000 / 3000.0;  // of the longest component
  for (unsigned i = 0; i < 3; ++i) p.t1[i] = binary32_bits(most == 0 ? 0.75 : d[i] / most * length);
  return p;
}

}  // namespace

TEST_CASE("exact triangles: random rays find the nearest triangle ahead, its distance and the place in it", "[system]") {
  test::rng random(211);
  const quantisation widths[] = {{}, {20, 24, 6, 16, 0}, {16, 20, 4, 12, 0}, {26, 28, 8, 20, 0}};
  tally sums, through_nodes;
  unsigned rays = 0, rays_through_nodes = 0;
  for (unsigned round = 0; round < 12; ++round) {
    design d;
    d.choose<bih_kind>();
    d.rtu.cores = 1 + random() % 4;
    d.of<bih_kind>().words = widths[round % 4];
    d.of<bih_kind>().core.early_out = round % 3 == 1;
    // In one leaf no roundings of a hierarchy keep a ray from a triangle.
    const bool one_leaf = round % 2 == 0;
    const auto all = random_corners(random, d.of<bih_kind>().words, 3 + random() % 20);
    const triangle_scene s = scene_of(all, d.of<bih_kind>().words, one_leaf ? 64 : 2, d.of<bih_kind>().core.address_bits);
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0; id < 500; ++id) jobs.push_back(random_ray(random, all, d.of<bih_kind>().words, id));
    CAPTURE(round, d.of<bih_kind>().words.n, one_leaf);
    compare(d, s, jobs, simulate(d, s.memory, jobs, static_cast<pace>(round % 3)), one_leaf ? sums : through_nodes);
    (one_leaf ? rays : rays_through_nodes) += 500;
  }
  CAPTURE(sums.hits, sums.misses, sums.unclear, sums.lost, sums.behind, sums.clipped, sums.greatest_error, through_nodes.hits,
          through_nodes.lost, through_nodes.greatest_error);
  CHECK(sums.lost == 0);
  CHECK(through_nodes.lost <= rays_through_nodes / 200);
  CHECK(sums.hits > 800);
  CHECK(sums.behind > 300);
  CHECK(sums.clipped > 100);
  CHECK(sums.misses > 300);
  CHECK(sums.unclear < rays / 10);
  CHECK(sums.greatest_error < 8);
  CHECK(through_nodes.greatest_error < 8);
}

TEST_CASE("exact triangles: of the teapot's rays the distance is the exact one within the roundings", "[system]") {
  const std::string folder = RTUSIM_SOURCE_DIR "/scenes/", name = folder + "teapot.toml";
  scene what;
  config::schema parameters;
  what.describe(parameters);
  parameters.read_toml(name, scene::home);
  const std::string file = folder + what.model.model;
  design d;
  d.choose<bih_kind>();
  const quantisation& q = d.of<bih_kind>().words;
  const triangle_model model =
      load_triangles(file, q, bih_builder_params{}.leaf_triangles, d.of<bih_kind>().core.address_bits, what.model.patch_quads);
  triangle_scene s = scene_of(quantise(read_mesh(file, what.model.patch_quads), q, file).corners, q, bih_builder_params{}.leaf_triangles,
                              d.of<bih_kind>().core.address_bits);
  REQUIRE(s.triangles.size() == model.hierarchy.triangles.size());
  std::vector<job_packet> jobs;
  const auto all = triangle_jobs(what.view, {64, 48}, model.grid, triangle_driver_params{}.norm, false);
  for (std::size_t i = 0; i < all.size(); i += 3) {
    jobs.push_back(all[i]);
    jobs.back().job_word = static_cast<std::uint32_t>(jobs.size() - 1);
  }
  tally sums;
  compare(d, s, jobs, simulate(d, model.hierarchy, jobs, pace::skipping), sums);
  CAPTURE(sums.hits, sums.misses, sums.unclear, sums.lost, sums.clipped);
  CHECK(sums.hits > 100);
  CHECK(sums.misses > 100);
  CHECK(sums.lost <= 1);
}

TEST_CASE("exact triangles: from between, in, before and behind three walls", "[system]") {
  // At z = 100, 200 and 300, each over the lower left half of a square of 400; a fourth makes the box 400 high.
  design d;
  d.choose<bih_kind>();
  d.of<bih_kind>().words = {10, 16, 4, 12, 0};
  const auto wall = [](std::int64_t z) { return corners{{{0, 0, z}, {400, 0, z}, {0, 400, z}}}; };
  const std::vector<corners> all{wall(100), wall(200), wall(300), {{{396, 400, 0}, {400, 396, 0}, {400, 400, 400}}}};
  const triangle_scene s = scene_of(all, d.of<bih_kind>().words, 4, d.of<bih_kind>().core.address_bits);
  REQUIRE(s.memory.corner == per_axis<std::int64_t>{400, 400, 400});
  struct row {
    const char* name;
    per_axis<double> from, along;
    int triangle;          // -1: none
    std::int64_t t, u, v;  // u and v, of vertices 2 and 1, in 400ths
  };
  const row table[] = {
      {"between two, up", {100, 50, 150}, {0, 0, 1}, 1, 50, 50, 100},
      {"between two, down", {100, 50, 150}, {0, 0, -1}, 0, 50, 50, 100},
      {"in one, up", {100, 50, 200}, {0, 0, 1}, 2, 100, 50, 100},
      {"in one, down", {100, 50, 200}, {0, 0, -1}, 0, 100, 50, 100},
      {"1 before one", {100, 50, 199}, {0, 0, 1}, 1, 1, 50, 100},
      {"1 behind it", {100, 50, 201}, {0, 0, 1}, 2, 99, 50, 100},
      {"1 behind it, back", {100, 50, 201}, {0, 0, -1}, 1, 1, 50, 100},
      {"in the last, up", {100, 50, 300}, {0, 0, 1}, -1, 0, 0, 0},
      {"all are behind", {100, 50, 350}, {0, 0, 1}, -1, 0, 0, 0},
      {"all are ahead", {100, 50, 350}, {0, 0, -1}, 2, 50, 50, 100},
      {"below all, up", {100, 50, 0}, {0, 0, 1}, 0, 100, 50, 100},
      {"below all, down", {100, 50, 0}, {0, 0, -1}, -1, 0, 0, 0},
      {"outside, in: counted from the box", {100, 50, -250}, {0, 0, 1}, 0, 100, 50, 100},
      {"outside, away", {100, 50, -250}, {0, 0, -1}, -1, 0, 0, 0},
      {"past the box, away", {100, 50, 650}, {0, 0, 1}, -1, 0, 0, 0},
      {"past the box, back: counted from the box", {100, 50, 650}, {0, 0, -1}, 2, 100, 50, 100},
      {"beside the walls", {300, 200, 150}, {0, 0, 1}, -1, 0, 0, 0},
      {"along one", {0, 50, 200}, {1, 0, 0}, -1, 0, 0, 0},
      {"slanting, up", {100, 50, 150}, {0.5, 0.25, 0.5}, 1, 100, 75, 150},
      {"slanting, down", {100, 50, 150}, {0.5, 0.25, -0.5}, 0, 100, 75, 150},
      {"slanting, back and up", {100, 50, 150}, {-0.25, -0.125, 0.5}, 1, 100, 38, 75},
  };
  std::vector<job_packet> jobs;
  for (const row& r : table) {
    job_packet& p = jobs.emplace_back();
    p.job_word = static_cast<std::uint32_t>(jobs.size() - 1);
    for (unsigned i = 0; i < 3; ++i) {
      p.t0[i] = binary32_bits(r.from[i] / 1024);
      p.t1[i] = binary32_bits(r.along[i]);
    }
  }
  for (const pace how : {pace::skipping, pace::stepped, pace::checked}) {
    const auto results = simulate(d, s.memory, jobs, how);
    for (std::size_t i = 0; i < results.size(); ++i) {
      const row& r = table[i];
      const mesh_result& got = results[i];
      CAPTURE(r.name, static_cast<int>(how), got.u, got.v);
      CHECK(got.hit == (r.triangle >= 0));
      CHECK(got.triangle == static_cast<std::uint32_t>(std::max(r.triangle, 0)));
      CHECK(got.t_hit == r.t);
      // An edge's 1.0 is 2^19, and a 400th of it about 1 310.
      CHECK(std::abs(got.u * 400 - r.u * 32'768) <= 400 * 164);
      CHECK(std::abs(got.v * 400 - r.v * 32'768) <= 400 * 164);
    }
  }
}

}  // namespace rtusim
