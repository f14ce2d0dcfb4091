#include "testbench/commands/explain_command.h"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/commands/options.h"
#include "testbench/kinds/host_kind.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"

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

std::string figures_text(const std::vector<config::report::entry>& entries, const std::function<bool(const std::string&)>& is_wanted) {
  std::string text;
  for (const auto& e : entries)
    if (is_wanted(e.key)) text += fmt::format("{}{}\n    {}\n", e.key, e.unit.empty() ? "" : "  [" + e.unit + "]", e.meaning);
  return text;
}

/// What an unknown key may have been meant for: a figure, or a component of one's key.
std::string nearest_figure(const std::string& key, const std::vector<config::report::entry>& entries) {
  std::vector<std::string> names;
  for (const auto& e : entries) names.push_back(e.key);
  for (const auto& e : entries)
    for (std::size_t dot = e.key.find('.'); dot != std::string::npos; dot = e.key.find('.', dot + 1))
      names.push_back(e.key.substr(dot + 1, e.key.find('.', dot + 1) - dot - 1));
  return config::nearest(key, names);
}

}  // namespace

std::string explain_text(const std::string& key) {
  const auto entries = statistics_entries();
  const auto begins = [&key](const std::string& k) {
    return key.empty() || (k.rfind(key, 0) == 0 && (k.size() == key.size() || k[key.size()] == '.'));
  };
  const auto holds = [&key](const std::string& k) { return k.find(key) != k.npos; };
  std::string figures = figures_text(entries, begins);
  if (!key.empty() && !figures.empty()) return figures;

  const run_parameters all;
  const config::schema& parameters = all.parameters;
  std::string text;
  try {
    text = parameters.explain(key);
    if (!key.empty()) return text;
  } catch (const input_error&) {
    text = parameters.explain_all_with(key);
    figures = figures_text(entries, holds);
    if (text.empty() && figures.empty()) {
      const std::string near = nearest_figure(key, entries);
      if (near.empty()) throw;
      throw input_error("explain", "no figure " + key, near);
    }
  }
  if (!text.empty() && !figures.empty()) text += "\nFigures of the statistics file:\n\n";
  return text + figures;
}

void add_explain(CLI::App& program) {
  auto key = std::make_shared<std::string>();
  CLI::App& app = add_command(program, "explain", "every parameter and statistic: unit, range, meaning", key,
                              [](const std::string& asked) { fmt::print("{}", explain_text(asked)); });
  app.add_option("KEY", *key, "only what begins so")->type_name("");
}

}  // namespace rtusim
