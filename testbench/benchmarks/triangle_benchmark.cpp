#include <benchmark/benchmark.h>

#include <chrono>
#include <string>

#include "modules/bih_core/bih_kind.h"
#include "modules/bih_core/bih_walk.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/bih_walker.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/replay/replay.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

/// What is measured: the teapot of 6,320 triangles at 640x360 from the front, errata off, rays that miss its box left out.
design triangle_design(unsigned cores) {
  design d;
  d.choose<bih_kind>();
  d.rtu.cores = cores;
  return d;
}

const triangle_model& teapot() {
  static const triangle_model model =
      load_triangles(RTUSIM_SOURCE_DIR "/scenes/data/teapot.bpt", {}, 8, bih_core_params().address_bits, 10);
  return model;
}

const std::vector<job_packet>& teapot_packets() {
  static const std::vector<job_packet> packets = [] {
    camera::params view;
    view.which = camera::params::kind::look_at;
    view.position = {1.6, 1.0, 2.0};
    view.vertical_fov_degrees = 50;
    return triangle_jobs(view, {640, 360}, teapot().grid, direction_norm::two, true);
  }();
  return packets;
}

void report(benchmark::State& state, double cycles) {
  using benchmark::Counter;
  state.counters["ns_per_ray"] =
      Counter(static_cast<double>(teapot_packets().size()) * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["ns_per_cycle"] = Counter(cycles * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

std::vector<triangle_job> teapot_rays() {
  const ray_setup setup({}, teapot().hierarchy.corner);
  ray_setup_stats stats;
  std::vector<triangle_job> rays;
  for (const job_packet& p : teapot_packets()) setup(p, stats, rays.emplace_back());
  return rays;
}

/// Traversal alone, and with the intersections.
void walk(benchmark::State& state, bool with_triangles) {
  const std::vector<triangle_job> rays = teapot_rays();
  const triangle_model& model = teapot();
  bih_walk walker(bih_core_params(), model.hierarchy);
  const triangle_intersector intersector({}, {});
  std::uint64_t cycles = 0;
  for (auto _ : state) {
    cycles = 0;
    std::uint64_t hits = 0;
    for (const triangle_job& job : rays) {
      const bih_outcome o = walker(job.ray, [&](std::uint32_t triangle, std::uint64_t) {
        if (with_triangles)
          hits += intersector.hit_only(job.ray.position, job.ray.direction, model.hierarchy.triangles[triangle]).hit;
        else
          hits += triangle;
      });
      cycles += o.cycles();
    }
    benchmark::DoNotOptimize(hits);
  }
  report(state, static_cast<double>(cycles));
}
BENCHMARK_CAPTURE(walk, alone, false)->Name("triangles/walk")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(walk, intersecting, true)->Name("triangles/walk_and_intersect")->Unit(benchmark::kMillisecond);

/// All that replay does before its schedule: set-up, traversal, intersections, each leaf's at once.
void walk_all(benchmark::State& state) {
  const bih_walker walker(triangle_design(1).of<bih_kind>(), teapot().hierarchy);
  for (auto _ : state) benchmark::DoNotOptimize(walk_rays(walker, teapot_packets(), static_cast<unsigned>(state.range(0))));
  report(state, 0);
}
BENCHMARK(walk_all)->Name("triangles/replay/walks/threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void replay_all(benchmark::State& state) {
  const design d = triangle_design(static_cast<unsigned>(state.range(0)));
  const bih_walker walker(d.of<bih_kind>(), teapot().hierarchy);
  double cycles = 0;
  for (auto _ : state) cycles = static_cast<double>(replay(d, {}, walker, teapot_packets(), 2, {}).results.total_cycles());
  report(state, cycles);
}
BENCHMARK(replay_all)->Name("triangles/replay/cores")->Arg(1)->Arg(16)->Unit(benchmark::kMillisecond)->UseRealTime();

void set_up(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(teapot_rays());
  report(state, 0);
}
BENCHMARK(set_up)->Name("triangles/ray_setup")->Unit(benchmark::kMillisecond);

/// A run a process, as SystemC elaborates once in each; the time is the run's alone.
void simulate(benchmark::State& state, pace p) {
  const design d = triangle_design(static_cast<unsigned>(state.range(0)));
  const auto& packets = teapot_packets();
  double cycles = 0;
  for (auto _ : state) {
    const std::string answer = in_child([&] {
      const surroundings around;
      simulation sim(d, around, bih_contents(teapot().hierarchy), packets, p);
      const auto begin = std::chrono::steady_clock::now();
      sim.run();
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      return fmt::format("{} {}", spent.count(), sim.total_cycles());
    });
    double spent = 0;
    if (std::sscanf(answer.c_str(), "%lf %lf", &spent, &cycles) != 2) return state.SkipWithError(answer.c_str());
    state.SetIterationTime(spent);
  }
  report(state, cycles);
}
void skipping(benchmark::State& state) { simulate(state, pace::skipping); }
void stepped(benchmark::State& state) { simulate(state, pace::stepped); }
BENCHMARK(skipping)->Name("triangles/skipping/cores")->Arg(1)->Arg(16)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(stepped)->Name("triangles/stepped/cores")->Arg(1)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace rtusim
