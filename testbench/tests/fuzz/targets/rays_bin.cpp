#include "scenes/rays/ray_list.h"
#include "testbench/kinds/driver.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {std::string(24, '\1'), std::string("\0\0\x80\x7f\0\0\xc0\x7f\0\0\x80\xff\0\0\0\0\0\0\0\x80\1\0\0\0", 24)};
}

void read(const std::filesystem::path& file) {
  const ray_list rays(file);
  list_jobs(rays, {}, 0);
  triangle_jobs(rays, {1000, {500, 400, 300}, {1000, 800, 600}, 10}, direction_norm::two, true);
}

const registered it{{"rays_bin", "rays.bin", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
