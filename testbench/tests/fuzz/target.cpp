#include "testbench/tests/fuzz/target.h"

#include <algorithm>
#include <fstream>

#include "modules/config/files.h"
#include "scenes/meshes/mesh.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"

namespace rtusim::fuzz {

std::vector<target>& targets() {
  static std::vector<target> all;
  return all;
}

std::filesystem::path tree() { return RTUSIM_SOURCE_DIR; }

std::string tree_file(const std::string& name) { return config::read_file(tree() / name); }

std::vector<std::string> with_cases(std::vector<std::string> first, const std::string& ending) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(tree() / "testbench/tests/cases"))
    if (entry.path().extension() == ending) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  for (const auto& file : found) first.push_back(config::read_file(file));
  return first;
}

std::filesystem::path place(const std::filesystem::path& folder, const target& t, const std::string& bytes) {
  const std::filesystem::path file = folder / t.file;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

void read_as_mesh(const std::filesystem::path& file) {
  const mesh m = read_mesh(file);
  find_open_edges(m);
  find_turned_edges(m);
  build_svo(voxelise_surface(m, 32), file.string());
}

void read_as_gltf(const std::filesystem::path& file) {
  const char* const name = "buffer with blank.bin";
  const std::filesystem::path buffer = file.parent_path() / name;
  if (!exists(buffer)) copy_file(tree() / "testbench/tests/cases" / name, buffer);
  read_as_mesh(file);
}

}  // namespace rtusim::fuzz
