#include <nlohmann/json.hpp>

#include "modules/config/files.h"
#include "testbench/commands/record_command.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"
#include "testbench/tests/fuzz/target.h"

namespace rtusim::fuzz {
namespace {

std::vector<std::string> seeds() {
  const run_setup s(run_sources{tree() / "scenes/teapot.toml", {}, {}, {}});
  const nlohmann::ordered_json sound{
      {"format", "rtusim statistics"},
      {"version", run_record::version},
      {"inputs",
       {{"scene", ""}, {"architecture", ""}, {"model", "a.svo"}, {"model_crc32", "00000000"}, {"jobs", ""}, {"jobs_crc32", "00000000"}}},
      {"parameters", s.parameters.values()},
      {"statistics", {{"rays", 3}, {"waits", {{"core", 0.5}}}, {"histogram", {1, 2, 3, 4, 5, 6, 7, 8, 9}}}},
      {"simulator", {{"pace", "skipping"}}}};
  return {sound.dump(2)};
}

void read(const std::filesystem::path& file) {
  difference_text(file, file);
  run_setup(nlohmann::json::parse(config::read_file(file))["parameters"], file.string(), file.parent_path());
}

const registered it{{"record", "record.json", seeds, read}};

}  // namespace
}  // namespace rtusim::fuzz
