#include "modules/config/files.h"
#include "testbench/commands/explain_command.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {"scheduler", "statistics.latency", "", "rtu.core"}; }

void read(const std::filesystem::path& file) { explain_text(config::read_file(file)); }

const registered it{{"explain", "key", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
