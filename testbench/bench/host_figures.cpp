#include "testbench/bench/host_figures.h"

namespace rtusim {

void host_figures::describe(config::report& r) const {
  r.number("unsent_rays", unsent_rays, "rays", "not sent, as they miss the model's box (driver.skip_misses)");
  r.number("replaced_components", replaced_components, "components", "of directions, too small for the format to divide by");
  r.number("duplicate_ids", duplicate_ids, "jobs", "with the id of an earlier job: a picture shows the nearest hit");
  if (!triangles) return;
  r.group("triangles", [this](config::report& g) {
    g.number("dropped", triangles->losses.dropped, "triangles", "without area on the grid");
    g.number("clamped", triangles->losses.clamped, "triangles", "with an edge too long for quantisation.edge_shift, which was cut");
    g.number("edge_shift", triangles->edge_shift, "bits", "quantisation.edge_shift, as given or as auto chose it");
  });
}

std::uint64_t duplicate_ids(const std::vector<job_packet>& jobs) {
  std::vector<bool> seen;
  std::uint64_t again = 0;
  for (const job_packet& job : jobs) {
    const std::size_t id = job.pixel();
    if (id >= seen.size()) seen.resize(2 * id + 1);
    again += seen[id];
    seen[id] = true;
  }
  return again;
}

}  // namespace rtusim
