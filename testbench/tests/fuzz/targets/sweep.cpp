#include "testbench/sweep/sweep_columns.h"
#include "testbench/sweep/sweep_plan.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

constexpr const char* of_all = R"toml(
[sweep]
scenes = ["../../scenes/dragon.toml"]
constraints = ["rtu.cores <= 16 || is(\"scheduler.policy=round_robin\")"]
record = ["total_cycles", "core_3.jobs", "channels.result"]
images = ["png", "cost.png"]
limit = 100
[set]
"source.valid" = "paced"
[axes]
"rtu.cores" = {from = 1, to = 16, factor = 2}
"rtu.clock_mhz" = {from = 0.1, to = 0.3, step = 0.1}
[[in_step]]
"frame.width" = [32, 64]
"frame.height" = [18, 36]
)toml";

std::vector<std::string> seeds() {
  return {of_all, tree_file("testbench/sweeps/core_count_sweep.toml"), tree_file("testbench/sweeps/cores_policies_frames.toml")};
}

void read(const std::filesystem::path& file) {
  // The scenes and architectures that the seeds name.
  for (const char* name : {"scenes", "testbench/architectures"})
    if (const auto link = file.parent_path() / "../.." / name; !exists(link)) create_directory_symlink(tree() / name, link);
  const sweep_plan plan(file);
  meanings_of(plan.axes());
}

const registered it{{"sweep", "testbench/sweeps/sweep.toml", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
