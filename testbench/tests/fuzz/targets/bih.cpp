#include <fstream>
#include <iterator>

#include "modules/config/files.h"
#include "modules/formats/bih_memory.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

const std::string bih_folder = "testbench/golden/bih/scenes/tetra_k1/";
// In order of the input's first byte, which says for which of them the rest stands; the others are sound.
constexpr const char* bih_files[] = {"bih0.txt.gz", "bih1.txt.gz", "bih2.txt.gz", "bih3.txt.gz", "scene_aabb.txt", "tri_ram.txt.gz"};

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (std::size_t i = 0; i < std::size(bih_files); ++i)
    seeds.push_back(std::string(1, static_cast<char>(i)) + tree_file(bih_folder + bih_files[i]));
  return seeds;
}

void read(const std::filesystem::path& file) {
  const std::string bytes = config::read_file(file);
  if (bytes.empty()) return;
  const std::size_t part = static_cast<unsigned char>(bytes[0]) % std::size(bih_files);
  for (std::size_t i = 0; i < std::size(bih_files); ++i)
    std::ofstream(file.parent_path() / bih_files[i], std::ios::binary)
        << (i == part ? bytes.substr(1) : tree_file(bih_folder + bih_files[i]));
  const bih_memory memory = read_bih(file.parent_path(), 10);
  check_bih(memory, file.string());
  check_bih(memory, file.string(), {true, true});
}

const registered it{{"bih", "memory/file", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
