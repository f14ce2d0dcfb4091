#include "modules/config/files.h"
#include "testbench/pictures/pictures.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {"a.png", "a.depth.png", "A.EXR"}; }

void read(const std::filesystem::path& file) { kind_of(config::read_file(file)); }

const registered it{{"picture_name", "name", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
