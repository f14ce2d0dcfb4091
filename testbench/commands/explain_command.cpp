#include "testbench/commands/explain_command.h"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/bench/simulation.h"
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

std::string reference_page() {
  const run_parameters all;
  std::string text =
      "# Parameters and figures\n\n"
      "Written by `rtusim explain --markdown`; a test holds it to the program. `rtusim explain KEY` tells the same in the terminal.\n\n"
      "## Parameters\n\n";
  text += explanation_markdown(all.parameters.explanations([](std::string_view) { return true; }));
  text += "\n## Figures of a statistics file\n\nFor each core `core_N`, and for each channel by its name.\n\n";
  text += config::markdown_row({"key", "unit", "meaning"}) + "| --- | --- | --- |\n";
  for (const auto& e : statistics_entries()) text += config::markdown_row({'`' + e.key + '`', e.unit, e.meaning});
  return text;
}

std::string timing_text(const std::filesystem::path& architecture, const std::vector<std::string>& assignments) {
  run_parameters all;
  if (!architecture.empty()) all.parameters.read_toml(architecture, design::home);
  for (const std::string& a : assignments) all.parameters.set(a);
  all.parameters.check_read();
  const auto contents = all.hardware.kind().blank_contents();
  const std::vector<job_packet> no_jobs;
  simulation idle(all.hardware, all.bench, *contents, no_jobs, pace::skipping);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);  // to the end of elaboration

  struct row {
    std::string first, last, timing;
  };
  std::vector<row> rows;
  for (const unit* u : idle.clock().units()) {
    const auto t = u->timing();
    if (!t) continue;
    const auto cycles = [&t](unsigned n) { return fmt::format("{}{}", t->beside_cost ? "cost + " : "", n); };
    const char* const passes[2][2] = {{"", "ready"}, {"valid", "valid, ready"}};
    const std::string timing = fmt::format("{:>10}  {:>10}  {:>8}  {}", cycles(t->latency_cycles), cycles(t->interval_cycles), t->capacity,
                                           passes[t->valid_passes][t->ready_passes]);
    if (!rows.empty() && rows.back().timing == timing)
      rows.back().last = u->basename();
    else
      rows.push_back({u->basename(), {}, timing});
  }
  std::string text = fmt::format("{:22}{:>10}  {:>10}  {:>8}  {}\n", "unit", "latency", "interval", "capacity", "within the cycle");
  for (const row& r : rows)
    text += fmt::format("{:22}{}\n", r.last.empty() ? r.first : r.first + " to " + r.last,
                        r.timing.substr(0, r.timing.find_last_not_of(' ') + 1));
  return text + R"(
latency    cycles from the one in which something enters to the first in which what comes of it may leave
interval   cycles between two that enter, at the least
capacity   how much a unit takes, of one input, while nothing leaves
within the cycle: valid passes from the input to the output, ready from the output to the input
cost       of the ray, as the log has it
)";
}

void add_explain(CLI::App& program) {
  struct request {
    std::string key;
    std::filesystem::path architecture;
    std::vector<std::string> assignments;
    bool markdown = false;
  };
  auto options = std::make_shared<request>();
  request& o = *options;
  CLI::App& app = add_command(program, "explain", "every parameter and statistic: unit, range, meaning; or the timing of a design's units",
                              options, [](const request& asked) {
                                if (asked.key == "timing" && !asked.markdown) {
                                  fmt::print("{}", timing_text(asked.architecture, asked.assignments));
                                  return;
                                }
                                if (!asked.architecture.empty() || !asked.assignments.empty())
                                  throw input_error("explain", "--arch or --set with \"" + asked.key + '"', "them with timing alone");
                                if (asked.markdown && !asked.key.empty())
                                  throw input_error("explain", "--markdown with \"" + asked.key + '"', "it alone: the page has all keys");
                                fmt::print("{}", asked.markdown ? reference_page() : explain_text(asked.key));
                              });
  app.add_option("KEY", o.key, "only what begins so; timing: latency, interval and capacity of each unit")->type_name("");
  app.add_flag("--markdown", o.markdown, "all of it as the page testbench/commands/REFERENCE.md");
  app.add_option("--arch", o.architecture, "for timing: the design, a TOML file")->type_name("FILE");
  app.add_option("--set", o.assignments, "for timing: a parameter")->type_name("KEY=VALUE")->allow_extra_args(false);
}

}  // namespace rtusim
