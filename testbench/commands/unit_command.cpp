#include "testbench/commands/unit_command.h"

#include <algorithm>
#include <system_error>

#include "modules/config/alternatives.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/schema.h"
#include "testbench/commands/options.h"
#include "testbench/kinds/host_kind.h"

namespace rtusim {
namespace {

std::vector<std::string> names_with(bool lone_unit::*what) {
  std::vector<std::string> names;
  const host_kinds hosts;
  for (const auto& kind : hosts.all())
    for (const lone_unit& u : kind->units())
      if (what == nullptr || u.*what) names.emplace_back(u.name);
  return names;
}

}  // namespace

std::string lone_unit_words() { return config::alternatives(names_with(nullptr)); }

void bench_unit(const unit_request& asked) {
  design d;
  host_kinds hosts;
  config::schema parameters;
  d.describe(parameters);
  hosts.describe(parameters, d);
  if (!asked.architecture.empty()) parameters.read_toml(asked.architecture, design::home);
  for (const std::string& a : asked.assignments) parameters.set(a);
  const lone_unit* unit = nullptr;
  std::vector<lone_unit> units;
  for (const auto& kind : hosts.all()) {
    units = kind->units();
    const auto found = std::find_if(units.begin(), units.end(), [&](const lone_unit& u) { return asked.name == u.name; });
    if (found == units.end()) continue;
    unit = &*found;
    d.choose(kind->word());
    break;
  }
  d.benched = asked.name;
  parameters.check_read();
  std::vector<std::filesystem::path> inputs{asked.files.jobs, asked.files.model, asked.architecture};
  std::error_code no_folder;
  for (std::filesystem::directory_iterator i(asked.files.memory, no_folder), end; !no_folder && i != end; i.increment(no_folder))
    inputs.push_back(i->path());
  config::check_writable_apart({asked.files.out}, inputs);
  if (unit == nullptr) throw input_error("unit", "unknown unit \"" + asked.name + '"', lone_unit_words());
  const bool model = !asked.files.model.empty();
  const bool memory_folder = !asked.files.memory.empty();
  const std::string place = "unit " + asked.name;
  if (!unit->reads_memory && memory_folder)
    throw input_error(place, "--memory", config::alternatives(names_with(&lone_unit::reads_memory)) + ", whose memory it is");
  if (unit->reads_model && !model) throw input_error(place, "no --model", "the octree in its memory");
  if (!unit->reads_model && model) throw input_error(place, "--model", "no octree: it has no model memory");
  if (unit->reads_memory && !memory_folder) throw input_error(place, "no --memory", "the folder of its memories");
  unit->bench(d, asked.files);
}

void add_unit(CLI::App& program) {
  auto options = std::make_shared<unit_request>();
  unit_request& o = *options;
  CLI::App& app = add_command(program, "unit", "one unit alone on raw words", options, bench_unit);
  app.add_option("NAME", o.name, lone_unit_words())->required()->type_name("");
  app.add_option("--jobs", o.files.jobs, "input columns, CSV")->required()->type_name("FILE");
  app.add_option("--out", o.files.out, "the same columns with the outputs, CSV")->required()->type_name("FILE");
  app.add_option("--model", o.files.model, "svo_core: the octree in its memory")->type_name("FILE");
  app.add_option("--memory", o.files.memory, "bih_core: the folder of its memories")->type_name("DIR");
  app.add_option("--arch", o.architecture, "the design, a TOML file")->type_name("FILE");
  app.add_option("--set", o.assignments, "a parameter; see 'rtusim explain'")->type_name("KEY=VALUE")->allow_extra_args(false);
}

}  // namespace rtusim
