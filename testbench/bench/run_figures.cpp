#include "testbench/bench/run_figures.h"

#include <fmt/format.h>

namespace rtusim {
std::vector<std::string> run_figures::warnings() const {
  std::vector<std::string> all;
  for (const auto& unit : units) unit.figures->warn(all);
  if (host.model) host.model->warn(all);
  if (host.duplicate_ids != 0)
    all.push_back(fmt::format("{} jobs have the id of an earlier one; a picture shows the nearest hit", host.duplicate_ids));
  return all;
}

void run_figures::describe(config::report& r) const {
  const auto rays = static_cast<double>(results.rays);
  const auto cycles = static_cast<double>(results.total_cycles());
  const double hz = clock_mhz * 1e6;
  r.number("total_cycles", results.total_cycles(), "cycles",
           "from the first that may accept a job to the one in which the last result leaves");
  r.number("last_result_cycle", results.last_result, "cycle", "number of that last cycle, as the thesis counts; cycle 0 is the first");
  r.number("last_accept_cycle", results.last_accepted, "cycle", "number of the cycle that accepts the last job");
  r.number("rays", results.rays, "rays", "jobs, each with its result");
  r.number("hits", results.hits, "rays", "rays that hit");
  r.number("cycles_per_ray", cycles / rays, "cycles", "total cycles by rays");
  r.number("rays_per_cycle", rays / cycles, "rays", "rays by total cycles");
  r.number("seconds", cycles / hz, "s", "total cycles at the clock");
  r.number("rays_per_second", rays * hz / cycles, "1/s", "rays at the clock");
  r.number("frames_per_second", hz / cycles, "1/s", "runs like this one at the clock");
  r.number("checksum", fmt::format("{:016x}", results.checksum), "", "over job word, hit, cost, cycle and t of all results, in order");
  r.group("host", [this](config::report& g) { host.describe(g); });
  r.group("latency", [this](config::report& g) { results.latency.describe(g, "cycles"); });
  r.group("cost", [this](config::report& g) { results.cost.describe(g, "cycles"); });
  r.group("waits", [&](config::report& g) { results.waits.describe(g, rays); });
  rtusim::describe(units, r);
  r.group("channels", [this](config::report& g) {
    for (const auto& [name, stats] : channels) g.group(name, [&s = stats](config::report& c) { s.describe(c); });
  });
}

}  // namespace rtusim
