#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return with_cases({ply(torus(), "ascii"), ply(torus(), "binary_little_endian"), ply(torus(), "binary_big_endian")}, ".ply");
}

const registered it{{"ply", "model.ply", seeds, read_as_mesh}};

}  // namespace
}  // namespace rtusim::fuzz
