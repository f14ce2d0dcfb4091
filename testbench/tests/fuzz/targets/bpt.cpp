#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {bpt(), tree_file("scenes/data/teapot.bpt")}; }

const registered it{{"bpt", "model.bpt", seeds, read_as_mesh}};

}  // namespace
}  // namespace rtusim::fuzz
