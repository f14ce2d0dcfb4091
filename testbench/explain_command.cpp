#include "testbench/explain_command.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/schema.h"
#include "modules/rtu/design.h"
#include "testbench/scene.h"
#include "testbench/run_figures.h"
#include "testbench/simulation.h"
#include "testbench/summary.h"

namespace rtusim {
namespace {

std::vector<config::report::entry> statistics_entries() {
  std::vector<config::report::entry> all;
  for (const auto& e : all_figures()) all.push_back({"statistics." + e.key, e.unit, e.meaning});
  config::report simulator("simulator");
  simulator_figures{}.describe(simulator);
  for (const auto& e : simulator.entries()) all.push_back(e);
  return all;
}

}  // namespace

std::string explain_text(const std::string& key) {
  const bool figure = key.rfind("statistics", 0) == 0 || key.rfind("simulator", 0) == 0;
  std::string text;
  if (!figure) {
    design d;
    surroundings around;
    scene what;
    config::schema parameters;
    d.describe(parameters);
    around.describe(parameters);
    what.describe(parameters);
    text = parameters.explain(key);
    if (!key.empty()) return text;
    text += "\nFigures of the statistics file:\n\n";
  }
  std::vector<std::string> names;
  std::string figures;
  const auto entries = statistics_entries();
  for (const auto& e : entries) {
    names.push_back(e.key);
    const bool inside = e.key.rfind(key, 0) == 0 && (e.key.size() == key.size() || e.key[key.size()] == '.');
    if (key.empty() || inside) figures += fmt::format("{}{}\n    {}\n", e.key, e.unit.empty() ? "" : "  [" + e.unit + "]", e.meaning);
  }
  if (figures.empty()) {
    const std::string near = config::nearest(key, names);
    throw input_error("explain", "no figure " + key, near.empty() ? "one that 'rtusim explain statistics' lists" : near);
  }
  return text + figures;
}

}  // namespace rtusim
