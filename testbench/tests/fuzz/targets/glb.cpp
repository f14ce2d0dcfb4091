#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return with_cases({glb(torus())}, ".glb"); }

const registered it{{"glb", "model.glb", seeds, read_as_gltf}};

}  // namespace
}  // namespace rtusim::fuzz
