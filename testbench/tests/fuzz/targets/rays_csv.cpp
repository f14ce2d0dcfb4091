#include "scenes/rays/ray_list.h"
#include "testbench/kinds/driver.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {"ox,oy,oz,dx,dy,dz\n0,0,-3,0,0,1\n1e-60,nan,inf,-inf,-0.5,+2\n", "id,dz,dy,dx,oz,oy,ox\r\n7,1,2,3,4,5,6\r\n"};
}

void read(const std::filesystem::path& file) {
  const ray_list rays(file);
  list_jobs(rays, {}, 0);
}

const registered it{{"rays_csv", "rays.csv", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
