#include "testbench/sweep/sweep_tables.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/printable.h"
#include "testbench/run/summary.h"
#include "testbench/sweep/sweep_columns.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;

constexpr int results_version = 2;
constexpr std::size_t most_reasons = 10;  // that are told

std::string csv_field(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

/// A point's figures, or why it has none.
struct row {
  const sweep_task* of;
  std::string reason;
  std::map<std::string, json> figures;
};

std::string reason_of(const sweep_task& t, const results_folder& folder) {
  const auto failure = folder.failure(t);
  return failure ? failure->reason : "not run";
}

/// The rows of all points, and the figures' columns in the order in which they are met.
struct table {
  std::vector<row> rows;
  std::vector<std::string> columns;

  table(const sweep_plan& plan, const std::vector<sweep_task>& tasks, const results_folder& folder) {
    std::set<std::string> missing(plan.record().begin(), plan.record().end());
    bool any = false;
    for (const sweep_task& t : tasks) {
      const auto record = folder.record(t);
      rows.push_back({&t, record ? "" : reason_of(t, folder), {}});
      if (!record) continue;
      any = true;
      for (const std::string& key : plan.record())
        if (add(key, (*record)["statistics"], rows.back())) missing.erase(key);
    }
    if (any && !missing.empty())
      throw input_error("sweep.record", fmt::format("{}, which no point has", fmt::join(missing, ", ")), "figures of these designs");
  }

  std::string csv(const sweep_plan& plan, const std::vector<column_meaning>& meanings, bool units) const {
    std::string text = "point,scene,architecture";
    for (const std::string& key : plan.axes()) text += ',' + csv_field(key);
    text += ",status,reason";
    for (const std::string& name : columns) text += ',' + csv_field(name);
    text += '\n';
    if (units) {
      text += ",,";
      for (std::size_t i = 0; i < plan.axes().size(); ++i) text += ',' + csv_field(meanings[i].unit);
      text += ",,";
      for (std::size_t i = plan.axes().size(); i < meanings.size(); ++i) text += ',' + csv_field(meanings[i].unit);
      text += '\n';
    }
    for (const row& r : rows) {
      const sweep_plan::point& p = *r.of->point;
      text += fmt::format("{},{},{}", r.of->name, csv_field(plan.scene_name(p)), csv_field(plan.architecture_name(p)));
      for (const auto* v : p.values) text += ',' + csv_field(v->shown);
      text += fmt::format(",{},{}", r.reason.empty() ? "done" : "failed", csv_field(r.reason));
      for (const std::string& name : columns) {
        text += ',';
        const auto at = r.figures.find(name);
        if (at != r.figures.end()) text += at->second.is_string() ? csv_field(at->second.get<std::string>()) : at->second.dump();
      }
      text += '\n';
    }
    return text;
  }

  std::string tree(const sweep_plan& plan, const std::vector<column_meaning>& meanings) const {
    json points = json::array(), about = json::object();
    for (const column_meaning& m : meanings) about[m.name] = {{"unit", m.unit}, {"meaning", m.meaning}};
    for (const row& r : rows) {
      const sweep_plan::point& p = *r.of->point;
      json axes = json::object(), figures = json::object();
      for (std::size_t i = 0; i < p.values.size(); ++i) axes[plan.axes()[i]] = p.values[i]->typed;
      for (const std::string& name : columns)
        if (const auto at = r.figures.find(name); at != r.figures.end()) figures[name] = at->second;
      points.push_back({{"point", r.of->name},
                        {"scene", plan.scene_name(p)},
                        {"architecture", plan.architecture_name(p)},
                        {"axes", axes},
                        {"status", r.reason.empty() ? "done" : "failed"},
                        {"reason", r.reason},
                        {"figures", figures}});
    }
    const json all{{"format", "rtusim sweep results"}, {"version", results_version}, {"columns", about}, {"points", points}};
    return all.dump(1, ' ', false, json::error_handler_t::replace) + '\n';
  }

 private:
  /// Takes a figure, or all of a group; whether it is there.
  bool add(const std::string& key, const json& statistics, row& to) {
    if (key.find_first_of("~/") != std::string::npos) return false;
    std::string pointer = '/' + key;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    const json::json_pointer at(pointer);
    if (!statistics.contains(at)) return false;
    std::vector<std::pair<std::string, json>> figures;
    flatten(statistics.at(at), key, figures);
    for (auto& [name, value] : figures) {
      if (value.is_array()) continue;
      if (known_.insert(name).second) columns.push_back(name);
      to.figures.emplace(name, std::move(value));
    }
    return true;
  }

  std::set<std::string> known_;
};

}  // namespace

std::vector<std::string> failures_of(const std::vector<sweep_task>& tasks, const results_folder& folder) {
  std::vector<std::string> reasons;
  for (const sweep_task& t : tasks)
    if (!folder.record(t)) reasons.push_back(reason_of(t, folder));
  return reasons;
}

std::vector<std::string> gather(const sweep_plan& plan, const std::vector<sweep_task>& tasks, const results_folder& folder, bool units) {
  const table all(plan, tasks, folder);
  std::vector<std::string> names = plan.axes();
  names.insert(names.end(), all.columns.begin(), all.columns.end());
  const std::vector<column_meaning> meanings = meanings_of(names);
  folder.put({{"results.csv", all.csv(plan, meanings, units)}, {"results.json", all.tree(plan, meanings)}});
  std::vector<std::string> reasons;
  for (const row& r : all.rows)
    if (!r.reason.empty()) reasons.push_back(r.reason);
  return reasons;
}

std::string failure_text(const std::vector<std::string>& reasons) {
  std::map<std::string, std::size_t> counts;
  for (const std::string& reason : reasons) ++counts[reason];
  std::vector<std::pair<std::string, std::size_t>> order(counts.begin(), counts.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  const auto add = [&](std::size_t points, const std::string& why) {
    text += fmt::format("rtusim: {} point{} failed: {}\n", points, points == 1 ? "" : "s", config::printable(why));
  };
  std::size_t left = reasons.size();
  for (std::size_t i = 0; i < std::min(order.size(), most_reasons); ++i) {
    add(order[i].second, order[i].first);
    left -= order[i].second;
  }
  if (left != 0) add(left, fmt::format("{} other reasons", order.size() - most_reasons));
  return text;
}

}  // namespace rtusim
