#include "modules/config/files.h"
#include "scenes/voxels/binvox.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"
#include "testbench/tests/scratch.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  const test::scratch_folder folder;
  write_binvox(folder / "a.binvox", voxel_cube(voxelise_surface(torus(), 32)));
  return with_cases({config::read_file(folder / "a.binvox")}, ".binvox");
}

void read(const std::filesystem::path& file) { build_svo(read_binvox(file).grid, file.string()); }

const registered it{{"binvox", "model.binvox", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
