#include "testbench/commands/record_command.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "modules/config/json.h"
#include "modules/config/printable.h"
#include "testbench/commands/options.h"
#include "testbench/run/procedure.h"
#include "testbench/run/record_paths.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;

json read_record(const std::filesystem::path& file) {
  const std::string text = config::read_file(file);
  const bool is_deep = config::json_levels(text) > config::most_json_levels;
  const json all = is_deep ? json() : json::parse(text, nullptr, false);
  const auto expected = fmt::format("a statistics file of version {}, as `rtusim run --stats` writes it", run_record::version);
  if (!all.is_object() || !all.contains("format") || all["format"] != "rtusim statistics")
    throw input_error(file.string(), "no statistics file", expected);
  if (!all.contains("version") || all["version"] != run_record::version)
    throw input_error(file.string(), "version " + (all.contains("version") ? all["version"].dump() : std::string("none")), expected);
  for (const char* part : {"inputs", "parameters", "statistics", "simulator"})
    if (!all.contains(part) || !all[part].is_object()) throw input_error(file.string(), std::string("no object ") + part, expected);
  for (const char* name : {"scene", "architecture", "model", "model_crc32", "jobs", "jobs_crc32"})
    if (!all["inputs"].contains(name) || !all["inputs"][name].is_string())
      throw input_error(file.string(), fmt::format("no text inputs.{}", name), expected);
  if (!all["simulator"].contains("pace") || !all["simulator"]["pace"].is_string())
    throw input_error(file.string(), "no text simulator.pace", expected);
  return all;
}

std::string shown(const json* value) {
  if (value == nullptr) return "-";
  if (value->is_string()) return value->get<std::string>().empty() ? "\"\"" : config::printable(value->get<std::string>());
  if (value->is_array() && value->size() > 8) return fmt::format("{} values", value->size());
  if (value->is_number_float()) return fmt::format("{:.6g}", value->get<double>());
  return config::printable(value->dump(-1, ' ', false, json::error_handler_t::replace));
}

std::string change(const json* a, const json* b) {
  if (a == nullptr || b == nullptr || !a->is_number() || !b->is_number()) return {};
  const double from = a->get<double>(), to = b->get<double>();
  if (from == 0) return {};
  const double percent = 100 * (to - from) / std::fabs(from);
  return fmt::format("{:+.2f} %", percent);
}

/// The rows of one part of two records.
std::string differences_of(const char* part, const json& a, const json& b) {
  std::vector<std::pair<std::string, json>> left, right;
  flatten(a[part], "", left);
  flatten(b[part], "", right);
  std::map<std::string, const json*> in_right, in_left;
  for (const auto& [key, value] : right) in_right[key] = &value;
  for (const auto& [key, value] : left) in_left[key] = &value;
  std::string text;
  const auto row = [&](const std::string& key, const json* x, const json* y) {
    text += fmt::format("  {:<44} {:>16}  {:>16}  {:>10}\n", config::printable(key), shown(x), shown(y), change(x, y));
  };
  for (const auto& [key, value] : left) {
    const auto other = in_right.find(key);
    if (other == in_right.end())
      row(key, &value, nullptr);
    else if (*other->second != value)
      row(key, &value, other->second);
  }
  for (const auto& [key, value] : right)
    if (in_left.count(key) == 0) row(key, nullptr, &value);
  return text.empty() ? text : fmt::format("{}\n{}", part, text);
}

/// The folder at which a record's files start, named as its user named the record.
std::filesystem::path folder_to_start_at(const std::filesystem::path& record) {
  return std::filesystem::is_symlink(record) ? folder_of_record(record) : record.parent_path();
}

}  // namespace

void rerun(const rerun_options& o) {
  const json old = read_record(o.record);
  const auto folder = folder_to_start_at(o.record);
  run_setup s(nlohmann::json::parse(old["parameters"].dump()), o.record.string(), folder);
  const auto file_of = [&](const char* name) { return place_of(folder, old["inputs"].value(name, "")); };
  const std::filesystem::path job_file = file_of("jobs");
  config::check_writable_apart({o.statistics}, {o.record, s.what.model.model, s.what.model.rays, job_file});
  const config::input_ledger read;
  run_inputs inputs(s, job_file, 2, false);
  config::check_apart({o.statistics}, read.names());  // a mesh may have more files than one
  for (const char* name : {"scene", "architecture", "jobs"}) inputs.record[name] = file_of(name).string();
  for (const char* name : {"model_crc32", "jobs_crc32"})
    if (old["inputs"].value(name, "") != inputs.record[name])
      throw input_error(o.record.string(), fmt::format("inputs.{} = {}", name, old["inputs"].value(name, "none")),
                        fmt::format("{}, of what lies there now", inputs.record[name].get<std::string>()));
  run_manner manner;
  if (old["simulator"]["pace"] == run_pace_words[static_cast<std::size_t>(run_pace::replay)]) manner.pace = quickest_pace(s);
  const traced_run run = trace(s, inputs, manner);
  run_record record = record_of(s, inputs, run);
  record.simulator = old["simulator"];
  if (!o.statistics.empty()) write_record(o.statistics, record);

  json then = old, now{{"inputs", record.inputs}, {"parameters", record.parameters}, {"statistics", record.statistics}};
  name_files_in_full(folder, then["inputs"], then["parameters"]);
  name_files_in_full({}, now["inputs"], now["parameters"]);
  const std::string differences = differences_of("parameters", then, now) + differences_of("statistics", then, now);
  if (!differences.empty()) {
    fmt::print(config::stream_beside({o.statistics}), "{}", differences);
    throw simulation_error(o.record.string() + ": run again, figures differ");
  }
  if (!o.quiet)
    fmt::print(config::stream_beside({o.statistics}), "the same figures again: {} cycles, checksum {}\n",
               run.figures.results.total_cycles(), shown(&record.statistics["checksum"]));
}

std::string difference_text(const std::filesystem::path& a, const std::filesystem::path& b) {
  json left = read_record(a), right = read_record(b);
  name_files_in_full(folder_to_start_at(a), left["inputs"], left["parameters"]);
  name_files_in_full(folder_to_start_at(b), right["inputs"], right["parameters"]);
  std::string text;
  for (const char* part : {"inputs", "parameters", "statistics"}) text += differences_of(part, left, right);
  return text;
}

void add_rerun(CLI::App& program) {
  auto options = std::make_shared<rerun_options>();
  rerun_options& o = *options;
  CLI::App& app =
      add_command(program, "rerun", "run what a statistics file records once more: the figures must be the same", options, rerun);
  app.add_option("STATS.json", o.record, "a statistics file")->required()->type_name("");
  app.add_option("--stats", o.statistics, "the new statistics file")->type_name("FILE");
  app.add_flag("--quiet", o.quiet, "no word when they are");
}

void add_diff(CLI::App& program) {
  auto files = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App& app =
      add_command(program, "diff", "what differs between two statistics files, in design and in result", files, [](const auto& two) {
        const std::string text = difference_text(two.first, two.second);
        fmt::print("{}", text.empty() ? "no difference\n" : text);
      });
  app.add_option("A.json", files->first, "a statistics file")->required()->type_name("");
  app.add_option("B.json", files->second, "another")->required()->type_name("");
}

}  // namespace rtusim
