#include <benchmark/benchmark.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "modules/svo_core/svo_kind.h"
#include "testbench/bench/simulation.h"
#include "testbench/benchmarks/frame_jobs.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

/// A frame a process, as SystemC elaborates once in each; the time is the run's alone.
void simulate(benchmark::State& state, pace p, const std::optional<waveform_window>& window) {
  const design d = as_built(static_cast<unsigned>(state.range(0)));
  const auto& jobs = frame_packets();
  const auto& image = dragon().words;
  double cycles = 0, edges = 0;
  for (auto _ : state) {
    const std::string answer = in_child([&] {
      const surroundings around;
      simulation sim(d, around, svo_contents(image), jobs, p, window);
      const auto begin = std::chrono::steady_clock::now();
      sim.run();
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      return fmt::format("{} {} {}", spent.count(), sim.total_cycles(), sim.clock().stats().edges);
    });
    double spent = 0;
    if (std::sscanf(answer.c_str(), "%lf %lf %lf", &spent, &cycles, &edges) != 3) return state.SkipWithError(answer.c_str());
    state.SetIterationTime(spent);
  }
  const auto rays = static_cast<double>(jobs.size());
  using benchmark::Counter;
  state.counters["ns_per_ray"] = Counter(rays * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["ns_per_cycle"] = Counter(cycles * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["edges_per_ray"] = edges / rays;
}

void skipping(benchmark::State& state) { simulate(state, pace::skipping, {}); }
void stepped(benchmark::State& state) { simulate(state, pace::stepped, {}); }
void checked(benchmark::State& state) { simulate(state, pace::checked, {}); }
void window(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "rtusim-benchmark.vcd";
  simulate(state, pace::skipping, waveform_window{file, 700'000, 700'200, {}});
  std::filesystem::remove(file);
}

BENCHMARK(skipping)->Name("pace/skipping/cores")->Arg(1)->Arg(4)->Arg(16)->Arg(64)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(stepped)->Name("pace/stepped/cores")->Arg(1)->Arg(4)->Arg(16)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(checked)->Name("pace/checked/cores")->Arg(16)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(window)->Name("pace/skipping_with_a_vcd_of_200_cycles/cores")->Arg(16)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rtusim
