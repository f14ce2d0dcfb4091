#include <benchmark/benchmark.h>

#include "scenes/meshes/mesh.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"

namespace rtusim {
namespace {

const mesh& dragon_mesh() {
  static const mesh m = read_mesh(RTUSIM_SOURCE_DIR "/scenes/data/dragon_res3.ply.gz");
  return m;
}

void voxelise(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(voxelise_surface(dragon_mesh(), static_cast<unsigned>(state.range(0))));
}
BENCHMARK(voxelise)->Name("scene/voxelise")->Arg(32)->Arg(256)->Unit(benchmark::kMillisecond);

void build(benchmark::State& state) {
  const voxel_grid grid = voxelise_surface(dragon_mesh(), static_cast<unsigned>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_svo(grid, "dragon"));
}
BENCHMARK(build)->Name("scene/build_svo")->Arg(32)->Arg(256)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rtusim
