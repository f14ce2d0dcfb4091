#include "testbench/run/job_file.h"
#include "testbench/tests/fuzz/models.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() { return {std::string(32, '\1'), zipped(std::string(320, '\2'))}; }

void read(const std::filesystem::path& file) { read_jobs(file); }

const registered it{{"jobs", "jobs.bin", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
