#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return with_cases({obj(torus())}, ".obj"); }

const registered it{{"obj", "model.obj", seeds, read_as_mesh}};

}  // namespace
}  // namespace rtusim::fuzz
