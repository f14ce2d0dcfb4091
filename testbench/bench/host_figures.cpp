#include "testbench/bench/host_figures.h"

namespace rtusim {

void host_figures::describe(config::report& r) const {
  r.number("unsent_rays", unsent_rays, "rays", "not sent, as they miss the model's box (driver.skip_misses)");
  r.number("replaced_components", replaced_components, "components", "of directions, too small for the format to divide by");
  r.number("duplicate_ids", duplicate_ids, "jobs", "with the id of an earlier job: a picture shows the nearest hit");
  if (model) model->describe(r);
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
