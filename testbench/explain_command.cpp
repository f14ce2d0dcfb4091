#include "testbench/explain_command.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/schema.h"
#include "modules/rtu/design.h"
#include "testbench/scene.h"
#include "testbench/simulation.h"
#include "testbench/summary.h"

namespace rtusim {
namespace {

/// The figures of the statistics file for one core and one channel; the others' are alike. Cores of other kinds have other figures.
template <class Jobs, class Core>
std::vector<config::report::entry> statistics_entries() {
  run_figures run;
  run.add(Jobs{});
  run.add(Core{});
  run.channels.emplace_back("job", channel_stats{});
  config::report all;
  all.group("statistics", [&](config::report& r) { run.describe(r); });
  all.group("simulator", [&](config::report& r) { simulator_figures{}.describe(r); });
  return all.entries();
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
  auto entries = statistics_entries<job_manager::stats, svo_core::stats>();
  for (const auto& e : statistics_entries<triangle_job_manager::stats, bih_core::stats>()) {
    const auto same = [&e](const auto& other) { return other.key == e.key; };
    if (std::none_of(entries.begin(), entries.end(), same)) entries.push_back(e);
  }
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
