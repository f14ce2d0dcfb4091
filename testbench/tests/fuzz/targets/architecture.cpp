#include "testbench/run/run_setup.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {tree_file("testbench/architectures/espe2019_as_built.toml"), tree_file("testbench/architectures/hanika2007_as_built.toml"),
          tree_file("testbench/architectures/hanika2007.toml"), "errata.all = true\n[[rtu.core]]\nkind = 'svo'\ncount = 3\n"};
}

void read(const std::filesystem::path& file) { run_setup(run_sources{{}, file, {}, "model.svo"}); }

const registered it{{"architecture", "architecture.toml", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
