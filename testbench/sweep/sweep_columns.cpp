#include "testbench/sweep/sweep_columns.h"

#include <algorithm>
#include <string_view>

#include "testbench/kinds/host_kind.h"
#include "testbench/run/run_setup.h"

namespace rtusim {
namespace {

/// The figure that stands for a column in `all_figures`: all cores have the same, and all channels.
std::string representative(const std::string& column) {
  constexpr std::string_view core = "core_", channel = "channels.";
  if (column.rfind(core, 0) == 0) {
    const std::size_t end = std::min(column.find_first_not_of("0123456789", core.size()), column.size());
    if (end != core.size()) return "core_0" + column.substr(end);
  }
  if (column.rfind(channel, 0) == 0) {
    const std::size_t end = std::min(column.find('.', channel.size()), column.size());
    if (end != channel.size()) return "channels.job" + column.substr(end);
  }
  return column;
}

/// Whether `key` is `group` or in it.
bool is_within(const std::string& key, const std::string& group) {
  return key.rfind(group, 0) == 0 && (key.size() == group.size() || key[group.size()] == '.');
}

}  // namespace

std::vector<column_meaning> all_axes() {
  const run_parameters known;
  std::vector<column_meaning> all{{"errata.all", "", "all errata"}};
  for (const auto& section : known.parameters.sections())
    for (const auto& p : section.parameters()) {
      all.push_back({p.key, p.unit, p.meaning});
      if (!p.alias.empty()) all.push_back({p.alias, p.unit, p.meaning});
    }
  return all;
}

const std::vector<std::string>& usual_record() {
  static const std::vector<std::string> keys{"total_cycles",
                                             "rays",
                                             "hits",
                                             "cycles_per_ray",
                                             "rays_per_second",
                                             "frames_per_second",
                                             "checksum",
                                             "latency",
                                             "waits",
                                             "channels.job",
                                             "channels.pending_job",
                                             "channels.result",
                                             "host",
                                             "job_manager.float_to_fixed.overflows",
                                             "job_manager.float_to_fixed.nans"};
  return keys;
}

bool is_figure(const std::string& name, std::vector<std::string>& names) {
  for (const auto& e : all_figures()) {
    if (is_within(e.key, representative(name))) return true;
    for (std::size_t end = e.key.find('.'); end != std::string::npos; end = e.key.find('.', end + 1)) names.push_back(e.key.substr(0, end));
    names.push_back(e.key);
  }
  return false;
}

std::vector<column_meaning> meanings_of(const std::vector<std::string>& columns) {
  std::vector<column_meaning> known = all_axes(), found;
  for (const auto& e : all_figures()) known.push_back({e.key, e.unit, e.meaning});
  for (const std::string& column : columns) {
    const std::string like = representative(column);
    const auto at = std::find_if(known.begin(), known.end(), [&](const column_meaning& m) { return m.name == like; });
    found.push_back(at == known.end() ? column_meaning{column, "", ""} : column_meaning{column, at->unit, at->meaning});
  }
  return found;
}

}  // namespace rtusim
