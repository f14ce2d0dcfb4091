#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return with_cases({text_stl(torus()), binary_stl(torus())}, ".stl"); }

const registered it{{"stl", "model.stl", seeds, read_as_mesh}};

}  // namespace
}  // namespace rtusim::fuzz
