#include "testbench/run/run_setup.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return with_cases({tree_file("scenes/dragon.toml"), tree_file("scenes/teapot_128.toml")}, ".toml"); }

void read(const std::filesystem::path& file) {
  const run_setup s(run_sources{file, {}, {}, {}});
  run_setup(nlohmann::json::parse(s.parameters.values().dump()), "record", file.parent_path());
}

const registered it{{"scene", "scene.toml", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
