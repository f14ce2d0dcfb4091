#include <benchmark/benchmark.h>

#include <stdexcept>

#include "modules/memory/memory.h"
#include "modules/svo_core/svo_batch.h"
#include "modules/svo_core/svo_kind.h"
#include "modules/svo_core/svo_walk.h"
#include "testbench/benchmarks/frame_jobs.h"
#include "testbench/benchmarks/reference_walk.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/replay.h"

namespace rtusim {
namespace {

void per_ray(benchmark::State& state, std::size_t rays) {
  state.counters["ns_per_ray"] =
      benchmark::Counter(static_cast<double>(rays) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void reference(benchmark::State& state) {
  const word_view words = view_of(dragon().words, {});
  const svo_walk walk(as_built().of<svo_kind>().core_with_format());
  for (const traversal_job& job : frame_jobs()) {
    const reference_outcome r = reference_walk(job, words);
    const svo_outcome o = walk(job, words);
    if (r.hit != o.hit || r.cost != o.cost || (r.hit && r.t_hit != o.t_hit)) throw std::logic_error("the yardstick walks elsewhere");
  }
  for (auto _ : state)
    for (const traversal_job& job : frame_jobs()) benchmark::DoNotOptimize(reference_walk(job, words));
  per_ray(state, frame_jobs().size());
}
BENCHMARK(reference)->Name("walk/reference")->Unit(benchmark::kMillisecond);

void ours(benchmark::State& state, const design& d) {
  const word_view words = view_of(dragon().words, {});
  const svo_walk walk(d.of<svo_kind>().core_with_format());
  for (auto _ : state)
    for (const traversal_job& job : frame_jobs()) benchmark::DoNotOptimize(walk(job, words));
  per_ray(state, frame_jobs().size());
}
BENCHMARK_CAPTURE(ours, as_built, as_built())->Name("walk/as_built")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ours, right, design())->Name("walk/right")->Unit(benchmark::kMillisecond);

design wide() {
  design d = as_built();
  d.of<svo_kind>().format = {24, 24};
  return d;
}
BENCHMARK_CAPTURE(ours, wide, wide())->Name("walk/48_bits")->Unit(benchmark::kMillisecond);

void convert_frame(benchmark::State& state) {
  const numeric::float_to_fixed_converter converter(as_built().of<svo_kind>().format, as_built().of<svo_kind>().conversion);
  numeric::float_to_fixed_stats stats;
  traversal_job job;
  for (auto _ : state) {
    for (const job_packet& packet : frame_packets()) {
      convert(packet, converter, stats, job);
      benchmark::DoNotOptimize(job);
    }
  }
  per_ray(state, frame_packets().size());
}
BENCHMARK(convert_frame)->Name("float_to_fixed/six_a_ray")->Unit(benchmark::kMillisecond);

void camera_frame(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(camera_jobs({}, {}, {true}, 0, static_cast<unsigned>(state.range(0))));
  per_ray(state, frame_packets().size());
}
BENCHMARK(camera_frame)->Name("camera/threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Conversion and walk in batches, one ray after the other and eight side by side.
void walk_batch(benchmark::State& state, bool lanes) {
  const svo_kind kind = as_built().of<svo_kind>();
  const svo_batch walk(kind.core_with_format(), kind.conversion, view_of(dragon().words, kind.memory_), lanes);
  std::vector<svo_walked> walked(frame_packets().size());
  for (auto _ : state) {
    numeric::float_to_fixed_stats stats;
    walk(frame_packets().data(), frame_packets().size(), walked.data(), stats);
    benchmark::DoNotOptimize(walked.data());
  }
  per_ray(state, frame_packets().size());
}
BENCHMARK_CAPTURE(walk_batch, one_by_one, false)->Name("walk/batch/one_by_one")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(walk_batch, side_by_side, true)->Name("walk/batch/side_by_side")->Unit(benchmark::kMillisecond);

void walk_all(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(
        walk_rays(svo_walker(as_built().of<svo_kind>(), dragon().words), frame_packets(), static_cast<unsigned>(state.range(0))));
  per_ray(state, frame_packets().size());
}
BENCHMARK(walk_all)->Name("replay/walks/threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void schedule(benchmark::State& state) {
  const design d = as_built(static_cast<unsigned>(state.range(0)));
  const auto walked = walk_rays(svo_walker(d.of<svo_kind>(), dragon().words), frame_packets(), 2);
  for (auto _ : state) benchmark::DoNotOptimize(replay(d, {}, svo_walker(d.of<svo_kind>(), dragon().words), *walked, {}));
  per_ray(state, frame_packets().size());
}
BENCHMARK(schedule)->Name("replay/schedule/cores")->Arg(1)->Arg(4)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);

void replay_all(benchmark::State& state) {
  const design d = as_built(static_cast<unsigned>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(replay(d, {}, svo_walker(d.of<svo_kind>(), dragon().words), frame_packets(), 2, {}));
  per_ray(state, frame_packets().size());
}
BENCHMARK(replay_all)->Name("pace/replay/cores")->Arg(1)->Arg(4)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace rtusim
