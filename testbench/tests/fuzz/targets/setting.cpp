#include "modules/config/files.h"
#include "testbench/run/run_setup.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  return {"rtu.cores=4",      "scheduler.policy = round_robin", "camera.position=[1, 2, 3]", "scene.model='a.svo'", "errata.all=true",
          "rtu.clock_mhz=1e2"};
}

void read(const std::filesystem::path& file) { run_setup(run_sources{{}, {}, {config::read_file(file)}, "model.svo"}); }

const registered it{{"setting", "setting", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
