#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/svo_builder.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {tree_file("testbench/golden/svo/models/dragon_8.svo"), tree_file("testbench/golden/svo/models/rand_16_far.svo"),
          tree_file("testbench/golden/svo/models/dragon_32s.svo"), tree_file("testbench/golden/svo/models/deep_4096.svo")};
}

void read(const std::filesystem::path& file) {
  const svo_image image = read_svo(file, widest_limits);
  describe(image, file.string(), widest_limits);
  coarse_voxels_of(image, 64);
}

const registered it{{"svo", "model.svo", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
