#include "testbench/sweep/sweep_identity.h"

#include <algorithm>

#include <fmt/format.h>

#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "scenes/meshes/mesh.h"
#include "testbench/run/procedure.h"
#include "testbench/run/summary.h"
#include "testbench/sweep/source_checksum.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;

/// What a point's folder means. Counted up when results of the same sources get another meaning, as by another compiler.
constexpr int results_meaning = 1;

/// The files that a run reads for its model and rays.
std::vector<config::input_file> inputs_of(const scene::model_params& m) {
  const config::input_ledger ledger;
  const std::string ending = config::unzipped_ending_of(m.model);
  if (ending == ".gltf" || ending == ".glb")
    read_mesh(m.model, m.patch_quads);  // and its buffers
  else if (!m.model.empty())
    config::read_file(m.model);
  if (!m.rays.empty()) config::read_file(m.rays);
  return ledger.files();
}

/// The parameters with the endings of files in place of their names: they tell how a file is read.
json nameless(json parameters) {
  for (const char* key : {"model", "rays"})
    if (auto& section = parameters["scene"]; section.contains(key))
      section[key] = config::unzipped_ending_of(section[key].get<std::string>());
  return parameters;
}

/// The parameters that rays and their walks depend on: all but those that the unit around the cores has, and what the cores' kind names.
json walked_on(json parameters, const host_kind& kind) {
  std::vector<std::string> timing_only{"rtu.cores", "rtu.clock_mhz", "scheduler", "result_manager", "source", "sink", "watchdog"};
  for (std::string& key : kind.timing_only()) timing_only.push_back(std::move(key));
  for (const std::string& key : timing_only) {
    const auto dot = key.find('.');
    if (dot == std::string::npos)
      parameters.erase(key);
    else if (const auto section = parameters.find(key.substr(0, dot)); section != parameters.end())
      section->erase(key.substr(dot + 1));
  }
  return parameters;
}

json checksums_of(const std::vector<config::input_file>& inputs) {
  json list = json::array();
  for (const config::input_file& f : inputs) list.push_back(f.sha256);
  return list;
}

std::string line_of(const json& all) { return all.dump(-1, ' ', false, json::error_handler_t::replace) + '\n'; }

}  // namespace

std::vector<sweep_task> tasks_of(const sweep_plan& plan) {
  std::map<std::pair<std::string, std::string>, std::vector<config::input_file>> known;
  std::vector<sweep_task> tasks;
  tasks.reserve(plan.points().size());
  for (std::size_t i = 0; i < plan.points().size(); ++i) {
    sweep_task t;
    t.number = i;
    t.point = &plan.points()[i];
    try {
      const auto s = plan.setup(*t.point);
      const auto& m = s->what.model;
      const auto files = std::pair(m.model, m.rays);
      if (known.count(files) == 0) known.emplace(files, inputs_of(m));
      t.inputs = known.at(files);
      const json parameters = nameless(s->parameters.values());
      t.identity = identity_of(*s, t.inputs);
      t.replayed = quickest_pace(*s) == run_pace::replay;
      t.name = config::sha256_of(line_of({{"inputs", checksums_of(t.inputs)}, {"parameters", parameters}})).substr(0, 16);
      t.walk = line_of({{"inputs", checksums_of(t.inputs)}, {"parameters", walked_on(parameters, s->host())}});
    } catch (const input_error& e) {
      t.failure = plan.named_as_written(e.what());
      t.name = config::sha256_of(fmt::format("point {} of {}: {}", i, plan.scene_name(*t.point), t.failure)).substr(0, 16);
    }
    tasks.push_back(std::move(t));
  }
  return tasks;
}

std::string identity_of(const run_setup& s, const std::vector<config::input_file>& inputs) {
  return line_of({{"meaning", results_meaning},
                  {"program", source_checksum()},
                  {"statistics", run_record::version},
                  {"inputs", checksums_of(inputs)},
                  {"parameters", nameless(s.parameters.values())}});
}

std::string changed_input(const std::vector<config::input_file>& expected, const std::vector<config::input_file>& read, bool whole) {
  const std::size_t both = std::min(expected.size(), read.size());
  for (std::size_t i = 0; i < both; ++i)
    if (expected[i].sha256 != read[i].sha256) return read[i].file.string();
  if (read.size() > both) return read[both].file.string();
  return whole && expected.size() > both ? expected[both].file.string() : "";
}

}  // namespace rtusim
