#include <algorithm>

#include "modules/config/error.h"
#include "modules/rtu/core_kinds.h"
#include "testbench/bench/run_figures.h"
#include "testbench/kinds/bih_host.h"
#include "testbench/kinds/host_kind.h"
#include "testbench/kinds/svo_host.h"

namespace rtusim {

kind_list<host_kind>& host_kinds::list() {
  static auto all = kind_list<host_kind>::of<svo_host, bih_host>();
  return all;
}

host_kinds::host_kinds() : all_(list().make()) {}

void host_kinds::describe(config::schema& s, const design& d) {
  for (const auto& kind : all_) kind->describe(s, [&d, word = kind->word()] { return d.kind().word() == word; });
}

const host_kind& host_kinds::of(const design& d) const {
  const auto found = std::find_if(all_.begin(), all_.end(), [&](const auto& kind) { return kind->word() == d.kind().word(); });
  if (found == all_.end()) throw simulation_error("cores of kind " + std::string(d.kind().word()) + " without a host's side");
  return **found;
}

std::vector<config::report::entry> all_figures() {
  std::vector<config::report::entry> entries;
  const host_kinds hosts;
  for (const auto& kind : core_kinds().make()) {
    run_figures run;
    run.units = kind->blank_figures();
    for (const auto& host : hosts.all())
      if (host->word() == kind->word()) run.host = host->blank_figures();
    run.channels.emplace_back("job", channel_stats{});
    config::report all;
    run.describe(all);
    for (const auto& e : all.entries()) {
      const auto same = [&e](const auto& other) { return other.key == e.key; };
      if (std::none_of(entries.begin(), entries.end(), same)) entries.push_back(e);
    }
  }
  return entries;
}

}  // namespace rtusim
