#include <catch2/catch.hpp>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/bih_core/bih_kind.h"
#include "modules/bih_core/bih_walk.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/bih_walker.h"
#include "testbench/replay/replay.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random_streams.h"
#include "testbench/tests/random_triangles.h"

namespace rtusim {
namespace {

/// A run's results in the order of leaving, and its statistics.
struct outcome {
  std::string log;
  std::string statistics;
};

std::string text_of(const mesh_result& r) {
  return fmt::format("{},{},{},{},{},{},{}\n", r.job_word, static_cast<int>(r.hit), r.triangle, r.t_hit, r.u, r.v, r.cost);
}

std::string log_line(cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
  return fmt::format("{},{},{},{}", c, r.core, latency_cycles, text_of(static_cast<const mesh_result&>(r)));
}

outcome replay_of(const design& d, const surroundings& s, const bih_memory& model, const std::vector<job_packet>& jobs, bool kept_walks) {
  outcome o;
  const auto note = [&](cycle c, const traversal_result& r, std::uint64_t latency_cycles) { o.log += log_line(c, r, latency_cycles); };
  const bih_walker walk(d.of<bih_kind>(), model);
  const run_figures figures = kept_walks ? replay(d, s, walk, *walk_rays(walk, jobs, 2), note) : replay(d, s, walk, jobs, 2, note);
  config::report report;
  figures.describe(report);
  o.statistics = report.values().dump();
  return o;
}

outcome simulate(const design& d, const surroundings& s, const bih_memory& model, const std::vector<job_packet>& jobs, pace p,
                 std::uint32_t shuffle = 0, std::uint32_t change_pace = 0) {
  const std::string both = in_child([&] {
    simulation sim(d, s, bih_contents(model), jobs, p);
    sim.clock().shuffle_units(shuffle);
    std::string log;
    test::rng random(change_pace);
    sim.board().on_result([&](cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
      log += log_line(c, r, latency_cycles);
      if (change_pace != 0 && random() % 4 == 0) sim.clock().set_pace(static_cast<pace>(random() % 3));
    });
    sim.run();
    config::report report;
    sim.figures().describe(report);
    return log + '\0' + report.values().dump();
  });
  const auto split = both.find('\0');
  if (split == std::string::npos) return {both, ""};
  return {both.substr(0, split), both.substr(split + 1)};
}

/// What each ray finds by itself, all of its triangles tested to the end.
std::set<std::string> alone(const design& d, const bih_memory& model, const std::vector<job_packet>& jobs) {
  const ray_setup setup(d.of<bih_kind>().words, model.corner);
  const triangle_intersector intersect(d.of<bih_kind>().words, d.of<bih_kind>().intersector.errata);
  bih_walk walk(d.of<bih_kind>().core_with_widths(), model);
  std::set<std::string> results;
  for (const job_packet& packet : jobs) {
    ray_setup_stats stats;
    triangle_job job;
    setup(packet, stats, job);
    mesh_result r;
    r.job_word = packet.job_word;
    const bih_outcome o = walk(job.ray, [&](std::uint32_t triangle, std::uint64_t) {
      const triangle_outcome hit = intersect(job.ray.position, job.ray.direction, model.triangles[triangle]);
      if (!hit.hit || (r.hit && static_cast<std::int64_t>(hit.t) >= r.t_hit)) return;
      r.hit = true;
      r.triangle = triangle;
      r.t_hit = static_cast<std::int64_t>(hit.t);
      r.u = static_cast<std::int64_t>(hit.u);
      r.v = static_cast<std::int64_t>(hit.v);
    });
    r.cost = static_cast<std::uint32_t>(o.cycles());
    results.insert(text_of(r));
  }
  return results;
}

/// The same of a run: without cycle, core and latency.
std::set<std::string> results_of(const std::string& log) {
  std::set<std::string> results;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    std::size_t at = 0;
    for (int field = 0; field < 3; ++field) at = line.find(',', at) + 1;
    results.insert(line.substr(at) + '\n');
  }
  return results;
}

/// The first fields of each.
std::set<std::string> cut(const std::set<std::string>& results, int fields) {
  std::set<std::string> shorter;
  for (const std::string& r : results) {
    std::size_t at = 0;
    for (int field = 0; field < fields; ++field) at = r.find_first_of(",\n", at) + 1;
    shorter.insert(r.substr(0, at));
  }
  return shorter;
}

}  // namespace

TEST_CASE("system: 200 random designs of triangle cores are the same in every pace, whatever the order of the units", "[system]") {
  test::rng random(1957);
  std::uint64_t hits = 0, rays = 0, whole = 0, replayed = 0;
  for (int round = 0; round < 200; ++round) {
    const design d = test::random_triangle_design(random);
    const surroundings s = test::random_streams(random);
    const bih_memory model = test::random_triangles(random, d);
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0, n = 1 + random() % 150; id < n; ++id) jobs.push_back(test::random_triangle_packet(random, id, d, model));

    CAPTURE(round, d.rtu.cores, d.of<bih_kind>().words.n, d.of<bih_kind>().words.m, model.triangles.size(),
            d.of<bih_kind>().core.rays_in_flight);
    const outcome skipping = simulate(d, s, model, jobs, pace::skipping);
    REQUIRE_FALSE(skipping.statistics.empty());
    for (const pace p : {pace::stepped, pace::checked}) {
      CAPTURE(static_cast<int>(p));
      const outcome other = simulate(d, s, model, jobs, p, p == pace::checked ? random() : 0);
      REQUIRE(skipping.log == other.log);
      REQUIRE(skipping.statistics == other.statistics);
    }
    const outcome shuffled = simulate(d, s, model, jobs, pace::skipping, 1 + random());
    REQUIRE(skipping.log == shuffled.log);
    REQUIRE(skipping.statistics == shuffled.statistics);
    const outcome changing = simulate(d, s, model, jobs, pace::skipping, 0, 1 + random());
    REQUIRE(skipping.log == changing.log);
    REQUIRE(skipping.statistics == changing.statistics);
    // A ray may wait for the division of the one before; what lies behind a hit need not be seen.
    const bool waits = d.of<bih_kind>().divider.kind == numeric::divider_kind::iterative;
    if (waits) {
      CHECK_THROWS_WITH(replay_of(d, s, model, jobs, false), Catch::Contains("--pace replay: an iterative divider"));
    } else {
      const outcome replay = replay_of(d, s, model, jobs, round % 2 == 0);
      REQUIRE(skipping.log == replay.log);
      REQUIRE(skipping.statistics == replay.statistics);
      ++replayed;
    }
    const int same = d.of<bih_kind>().core.early_out ? 2 : waits ? 6 : 7;
    REQUIRE(cut(results_of(skipping.log), same) == cut(alone(d, model, jobs), same));
    whole += same == 7;
    const auto figures = nlohmann::json::parse(skipping.statistics);
    hits += figures["hits"].get<std::uint64_t>();
    rays += figures["rays"].get<std::uint64_t>();
  }
  CHECK(rays > 10'000);
  CHECK(hits > 3'000);
  CHECK(whole > 50);
  CHECK(replayed > 80);
}

}  // namespace rtusim
