#include "modules/bih_core/bih_machine.h"

#include <catch2/catch.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "modules/bih_core/bih_walk.h"
#include "modules/config/csv.h"
#include "testbench/tests/random_bih.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/bih/";
constexpr std::int64_t any_word = std::numeric_limits<std::int64_t>::max();
constexpr std::uint64_t most_steps = 1'000'000;

quantised_ray ray_of(const csv_table& table, std::size_t row) {
  const auto word = [&](const char* name) { return table.number(row, table.column(name), -any_word, any_word); };
  quantised_ray ray;
  ray.position = {word("pos_x"), word("pos_y"), word("pos_z")};
  ray.direction = {word("dir_x"), word("dir_y"), word("dir_z")};
  ray.reciprocal = {word("idir_x"), word("idir_y"), word("idir_z")};
  return ray;
}

/// A ray's triangles, with the clocks in which they were issued.
using issues = std::vector<std::pair<std::uint32_t, std::uint64_t>>;

/// Some distance or none for each triangle.
std::int64_t distance_of(std::uint32_t triangle, const bih_core_params& p) {
  const std::uint64_t mixed = (triangle + 1) * 0x9e3779b97f4a7c15u;
  return mixed >> 62 == 0 ? no_hit : static_cast<std::int64_t>(mixed >> 8 & ((std::uint64_t{1} << p.widths.n) - 1));
}

/// Steps a ray to its end.
issues step_through(bih_machine& machine, const quantised_ray& ray, const bih_core_params& p) {
  issues all;
  machine.start(ray);
  for (std::uint64_t clock = 0; machine.busy() && !machine.outcome().overflow; ++clock) {
    if (machine.signals().tri_en) {
      all.emplace_back(machine.signals().tri_num, clock);
      machine.result(distance_of(machine.signals().tri_num, p));
    }
    machine.step();
    REQUIRE(clock < most_steps);
  }
  return all;
}

bool same(const bih_kept& a, const bih_kept& b) {
  return a.tmin == b.tmin && a.tmax == b.tmax && a.dist0 == b.dist0 && a.dist1 == b.dist1 && a.address3x == b.address3x &&
         a.address1x == b.address1x && a.stack == b.stack;
}

/// A hierarchy of `levels` inner nodes across x, each with a leaf and the next node; a ray that meets all goes down `to_left` or right
/// first.
bih_memory ladder(unsigned levels, bool to_left, unsigned address_bits = 10) {
  bih_memory memory(address_bits);
  memory.corner = {1'000, 1'000, 1'000};
  memory.triangles.resize(1);
  const auto put = [&](std::uint32_t node, const bih_words& words) {
    for (unsigned w = 0; w < 3; ++w) memory.words[w][node] = words[w];
  };
  std::uint32_t node = 0;
  for (unsigned i = 0; i < levels; ++i) {
    const std::uint32_t left = 2 * i + 1;
    put(node, make_inner(0, left, 1'000, 0));
    put(to_left ? left + 1 : left, make_leaf(0, 1));
    node = to_left ? left : left + 1;
  }
  put(node, make_leaf(0, 1));
  return memory;
}

/// From (500, 500, 500) along +x.
quantised_ray along_x() {
  constexpr std::int64_t parallel = (std::int64_t{1} << 47) - 1;
  return {{500, 500, 500}, {}, {1 << 16, parallel, parallel}};
}

}  // namespace

TEST_CASE("bih_machine: the traces cycle by cycle, signal for signal", "[bih_core]") {
  for (const std::string scene : {"tetra_k1", "cube_k2", "cubepot_k4"}) {
    const bih_memory memory = read_bih(golden + "scenes/" + scene, 10);
    const csv_table rays(golden + "bih_" + scene + "_400.csv.gz");
    const csv_table trace(golden + "trace_" + scene + "_400.csv.gz");
    REQUIRE(trace.rows() > 400);
    bih_machine machine(test::bih_as_built(), memory);
    for (std::size_t row = 0; row < trace.rows(); ++row) {
      const auto number = [&](const char* name) { return trace.number(row, trace.column(name), -any_word, any_word); };
      CAPTURE(scene, row);
      if (!machine.busy()) machine.start(ray_of(rays, static_cast<std::size_t>(number("ray"))));
      const auto& r = machine.now();
      const auto& s = machine.signals();
      REQUIRE(number("clock") == static_cast<std::int64_t>(row));
      REQUIRE(bih_state_words[static_cast<std::size_t>(r.state)] == trace.field(row, trace.column("state")));
      REQUIRE(s.done == number("done"));
      REQUIRE(s.tri_en == number("tri_en"));
      if (s.tri_en) REQUIRE(s.tri_num == number("tri_num"));
      REQUIRE(r.stack_pos == number("stack_pos"));
      REQUIRE(s.addr3x == number("addr3x"));
      REQUIRE(s.we == number("we"));
      REQUIRE(r.tmin == number("tmin"));
      REQUIRE(r.tmax == number("tmax"));
      REQUIRE(r.dist0 == number("dist0"));
      REQUIRE(r.dist1 == number("dist1"));
      const bool at_leaf = r.state == bih_state::node && node_axis(machine.words()[0]) == bih_leaf;
      const std::uint32_t stack = memory.stack_address();
      // Elsewhere addr1x is what a latch left.
      const bool told = r.state == bih_state::aabb || at_leaf || (r.state == bih_state::leaf && !s.done) ||
                        (r.state == bih_state::inner && s.addr3x >= stack);
      if (told) REQUIRE(s.addr1x == number("addr1x"));
      machine.step();
    }
    CHECK_FALSE(machine.busy());
  }
}

TEST_CASE("bih_walk: the vectors' rays, their clocks and triangles", "[bih_core]") {
  for (const std::string table : {"bih_tetra_k1_400", "bih_cube_k2_400", "bih_cubepot_k4_400", "frame_cubepot_k8_64x48_m1"}) {
    const std::size_t at = table.find('_') + 1;
    const bih_memory memory = read_bih(golden + "scenes/" + table.substr(at, table.find('_', table.find('_', at) + 1) - at), 10);
    check_bih(memory, table);
    const csv_table rays(golden + table + ".csv.gz");
    bih_walk walk(test::bih_as_built(), memory);
    std::uint64_t clocks = 0;
    for (std::size_t row = 0; row < rays.rows(); ++row) {
      std::string triangles;
      const bih_outcome o = walk(ray_of(rays, row), [&](std::uint32_t triangle, std::uint64_t) {
        triangles += (triangles.empty() ? "" : ";") + std::to_string(triangle);
      });
      const bih_visits& v = o.visits;
      const std::uint64_t figures[] = {o.cycles(), v.aabb, v.node, v.inner, v.push, v.pop, v.leaf, o.max_stack, o.triangles};
      const char* const names[] = {"clocks", "aabb", "node", "inner", "push", "pop", "leaf", "max_stack", "ntris"};
      CAPTURE(table, row);
      for (std::size_t i = 0; i < std::size(names); ++i)
        REQUIRE(figures[i] == static_cast<std::uint64_t>(rays.number(row, rays.column(names[i]), 0, any_word)));
      REQUIRE(triangles == rays.field(row, rays.column("tris")));
      clocks += o.cycles();
    }
    if (table[0] == 'f') CHECK(clocks == 120'918);
  }
}

TEST_CASE("bih_walk: a frame's triangles in the clocks of the whole design", "[bih_core]") {
  const bih_memory memory = read_bih(golden + "scenes/cubepot_k8", 10);
  const csv_table rays(golden + "frame_cubepot_k8_64x48_m1.csv.gz");
  const csv_table top(golden + "top_cubepot_k8_64x48_m1.csv.gz");
  const auto clock_out = top.column("clock_out"), number = top.column("tri");
  bih_walk walk(test::bih_as_built(), memory);
  std::uint64_t before = 0;
  std::size_t line = 0;
  for (std::size_t row = 0; row < rays.rows(); ++row) {
    const bih_outcome o = walk(ray_of(rays, row), [&](std::uint32_t triangle, std::uint64_t clock) {
      REQUIRE(line < top.rows());
      REQUIRE(triangle == top.number(line, number, 0, any_word));
      REQUIRE(static_cast<std::int64_t>(before + clock + bih_result_latency_cycles) == top.number(line, clock_out, 0, any_word));
      ++line;
    });
    before += o.cycles();
  }
  CHECK(line == top.rows());
}

TEST_CASE("bih_core: early_out keeps a frame's nearest hits, in fewer clocks", "[bih_core]") {
  const bih_memory memory = read_bih(golden + "scenes/cubepot_k8", 10);
  const csv_table rays(golden + "frame_cubepot_k8_64x48_m1.csv.gz");
  const csv_table top(golden + "top_cubepot_k8_64x48_m1.csv.gz");
  const auto number = top.column("tri"), hit = top.column("hit"), t = top.column("t");
  bih_core_params p = test::bih_as_built();
  p.early_out = true;
  bih_walk walk(p, memory);
  std::size_t first = 0, hits = 0;
  std::uint64_t clocks = 0;
  for (std::size_t row = 0; row < rays.rows(); ++row) {
    // What became of the ray's triangles as built; t leaves without its last bit.
    std::map<std::uint32_t, std::int64_t> distances;
    const auto count = static_cast<std::size_t>(rays.number(row, rays.column("ntris"), 0, any_word));
    std::int64_t nearest = no_hit, found = no_hit;
    for (std::size_t line = first; line < first + count; ++line) {
      const std::int64_t distance = top.number(line, hit, 0, 1) != 0 ? 2 * top.number(line, t, 0, any_word) : no_hit;
      distances[static_cast<std::uint32_t>(top.number(line, number, 0, any_word))] = distance;
      nearest = std::min(nearest, distance);
    }
    first += count;
    const bih_outcome o = walk(ray_of(rays, row), [&](std::uint32_t triangle, std::uint64_t) -> std::int64_t {
      found = std::min(found, distances.at(triangle));
      return distances.at(triangle);
    });
    CAPTURE(row);
    REQUIRE(found == nearest);
    REQUIRE(o.cycles() <= static_cast<std::uint64_t>(rays.number(row, rays.column("clocks"), 0, any_word)));
    hits += nearest != no_hit;
    clocks += o.cycles();
  }
  CHECK(hits == 570);
  CHECK(clocks == 96'305);  // of 120,918
}

TEST_CASE("bih_machine: the walk at once comes to the same as the states one by one", "[bih_core]") {
  test::rng random(17);
  std::uint64_t triangles = 0, overflows = 0, missed = 0, wraps = 0, empty = 0, dropped = 0;
  for (int design = 0; design < 400; ++design) {
    const bih_core_params p = test::random_bih_core(random);
    bih_core_params whole = p;
    whole.early_out = false;
    const bih_memory memory = test::random_bih(random, p);
    bih_walk walk(p, memory), whole_walk(whole, memory);
    bih_machine machine(p, memory);
    for (int number = 0; number < 100; ++number) {
      const quantised_ray ray = test::random_ray(random, p);
      CAPTURE(design, number);
      if (random() % 4 == 0) machine.inherit(walk.kept());
      const issues stepped = step_through(machine, ray, p);
      issues walked;
      const bih_outcome o = walk(ray, [&](std::uint32_t triangle, std::uint64_t clock) -> std::int64_t {
        walked.emplace_back(triangle, clock);
        return distance_of(triangle, p);
      });
      const bih_outcome& wanted = machine.outcome();
      REQUIRE(o.overflow == wanted.overflow);
      REQUIRE(walked == stepped);
      overflows += o.overflow;
      if (o.overflow) {  // the core stops here for good
        machine = bih_machine(p, memory);
        walk = whole_walk = bih_walk(p, memory);
        continue;
      }
      REQUIRE(o.visits.aabb == 1);
      REQUIRE(o.visits.node == wanted.visits.node);
      REQUIRE(o.visits.inner == wanted.visits.inner);
      REQUIRE(o.visits.push == wanted.visits.push);
      REQUIRE(o.visits.pop == wanted.visits.pop);
      REQUIRE(o.visits.leaf == wanted.visits.leaf);
      REQUIRE(o.triangles == wanted.triangles);
      REQUIRE(o.max_stack == wanted.max_stack);
      REQUIRE(same(walk.kept(), machine.kept()));
      triangles += o.triangles;
      missed += o.cycles() == 1;
      wraps += o.visits.push != o.visits.pop;
      empty += o.visits.leaf != o.triangles;
      if (p.early_out) dropped += whole_walk(ray, [](std::uint32_t, std::uint64_t) {}).triangles > o.triangles;
    }
  }
  CHECK(triangles > 100'000);
  CHECK(overflows > 10);
  CHECK(missed > 1'000);
  CHECK(wraps > 10);
  CHECK(empty > 100);
  CHECK(dropped > 100);
}

TEST_CASE("bih_core: the box as built, and right", "[bih_core]") {
  constexpr std::int64_t one = 1 << 16, parallel = (std::int64_t{1} << 47) - 1, grid = std::int64_t{1} << 30;
  struct row {
    const char* name;
    quantised_ray ray;
    std::int64_t tmax_as_built, tmin, tmax;
    bool missed;
  };
  // The box is 1000 x 2000 x 3000.
  const row table[] = {
      {"from inside", {{10, 20, 30}, {}, {one, parallel, parallel}}, 990, 0, 990, false},
      {"down from inside", {{10, 20, 30}, {}, {-one, parallel, parallel}}, 10, 0, 10, false},
      {"down from a face at 0", {{0, 20, 30}, {}, {-one, parallel, parallel}}, grid, 0, 0, false},
      {"up from the upper face", {{1000, 20, 30}, {}, {one, parallel, parallel}}, 0, 0, 0, false},
      {"down from outside", {{1100, 20, 30}, {}, {-one, parallel, parallel}}, 1100, 100, 1100, false},
      {"up from outside", {{1100, 20, 30}, {}, {one, parallel, parallel}}, grid - 100, 0, -100, true},
      {"past an edge", {{1100, 1990, 30}, {}, {-one, one, parallel}}, 10, 100, 10, true},
      {"parallel outside", {{10, 2100, 30}, {}, {one, parallel, parallel}}, 990, 0, -(100 * parallel >> 16) - 1, true},
  };
  for (const row& r : table) {
    CAPTURE(r.name);
    const bih_interval built = box_interval(r.ray, {1000, 2000, 3000}, test::bih_as_built());
    CHECK(built.tmin == 0);
    CHECK(built.tmax == r.tmax_as_built);
    CHECK_FALSE(built.missed);
    const bih_interval right = box_interval(r.ray, {1000, 2000, 3000}, {});
    CHECK(right.tmin == r.tmin);
    CHECK(right.tmax == r.tmax);
    CHECK(right.missed == r.missed);
  }

  const bih_memory memory = read_bih(golden + "scenes/cube_k2", 10);
  bih_core_params p;
  p.address_bits = 10;
  bih_walk walk(p, memory);
  const bih_outcome o = walk({{grid - 1, 0, 0}, {}, {one, one, -one}}, [](std::uint32_t, std::uint64_t) {});
  CHECK(o.cycles() > 1);  // along the edge of the box
  bih_memory smaller = memory;
  smaller.corner[0] -= 1;
  bih_machine machine(p, smaller);
  machine.start({{grid - 1, 0, 0}, {}, {one, one, -one}});
  CHECK(machine.signals().done);
  machine.step();
  CHECK_FALSE(machine.busy());
  CHECK(machine.outcome().cycles() == 1);
}

TEST_CASE("bih_core: a stack of 31 entries", "[bih_core]") {
  for (const unsigned levels : {31u, 32u, 40u}) {
    CAPTURE(levels);
    const bih_memory memory = ladder(levels, true);
    for (const bool wraps : {false, true}) {
      bih_core_params p;
      p.address_bits = 10;
      p.stack_wraps = wraps;
      bih_walk walk(p, memory);
      const bih_outcome o = walk(along_x(), [](std::uint32_t, std::uint64_t) {});
      CHECK(o.overflow == (levels > 31 && !wraps));
      if (o.overflow) continue;
      CHECK(o.max_stack == 31);
      CHECK(o.triangles == (levels < 32 ? levels + 1 : levels - 31));  // as built the 32 below are lost
      CHECK(o.visits.push == levels);
    }
  }
  // A ray the other way visits the leaves first, and needs one entry.
  quantised_ray back = along_x();
  back.reciprocal[0] = -back.reciprocal[0];
  bih_core_params p;
  p.address_bits = 10;
  const bih_outcome o = bih_walk(p, ladder(40, true))(back, [](std::uint32_t, std::uint64_t) {});
  CHECK_FALSE(o.overflow);
  CHECK(o.max_stack == 1);
  CHECK(o.triangles == 41);
  CHECK(std::string(bih_stack_overflow("bih_core_3", 17).what()) ==
        "bih_core_3: ray 17 pushes an entry on a stack that holds 31: the hierarchy needs fewer levels");
}

TEST_CASE("bih_core: a leaf of 0 triangles takes one cycle in LEAF", "[bih_core]") {
  bih_memory memory = ladder(1, true);
  memory.words[1][1] = 0;
  bih_core_params p;
  p.address_bits = 10;
  bih_machine machine(p, memory);
  const issues all = step_through(machine, along_x(), p);
  CHECK(all == issues{{0, 8}});  // aabb, node, inner, push, node, leaf, pop, node
  CHECK(machine.outcome().cycles() == 9);
}

TEST_CASE("bih_core: early_out drops what begins behind a hit that is known", "[bih_core]") {
  // Two leaves: x to 500, and from 700 on, where the ray arrives at 200.
  bih_memory memory = ladder(1, true);
  memory.words[1][0] = 1'000;
  memory.words[2][0] = 700;
  memory.words[3][0] = 0;
  memory.words[3][1] = 1;
  memory.words[0][2] = make_leaf(1, 1)[0];
  memory.triangles.resize(2);
  struct row {
    const char* name;
    unsigned latency;
    std::int64_t distance;
    bool visited;
  };
  // Triangle 0 is issued in clock 5, POP is clock 6.
  const row table[] = {{"in time", 1, 199, false}, {"late", 2, 199, true}, {"not nearer", 1, 200, true}, {"no hit", 1, no_hit, true}};
  for (const row& r : table) {
    CAPTURE(r.name);
    bih_core_params p;
    p.address_bits = 10;
    p.early_out = true;
    p.result_latency_cycles = r.latency;
    bih_machine machine(p, memory);
    machine.start(along_x());
    std::uint64_t seen = 0;
    while (machine.busy()) {
      if (machine.signals().tri_en && ++seen == 1) machine.result(r.distance);
      machine.step();
    }
    CHECK(seen == (r.visited ? 2 : 1));
    CHECK(machine.outcome().cycles() == (r.visited ? 9 : 7));
    bih_walk walk(p, memory);
    const bih_outcome o = walk(along_x(), [&](std::uint32_t, std::uint64_t) -> std::int64_t { return r.distance; });
    CHECK(o.cycles() == machine.outcome().cycles());
  }
}

}  // namespace rtusim
