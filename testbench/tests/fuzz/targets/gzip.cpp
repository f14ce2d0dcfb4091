#include "modules/config/files.h"
#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {zipped("words\n"), zipped("a") + zipped(std::string(70'000, 'b')), "no gzip at all"}; }

void read(const std::filesystem::path& file) { config::read_file(file, 1 << 26); }

const registered it{{"gzip", "words.gz", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
