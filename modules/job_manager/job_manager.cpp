#include "modules/job_manager/job_manager.h"

namespace rtusim {

job_manager::job_manager(const sc_core::sc_module_name& name, const params& p) : pipeline_unit(name), params_(p) {}

traversal_job convert(const job_packet& packet, const job_manager::params& p, numeric::float_to_fixed_stats& stats) {
  traversal_job job;
  job.job_word = packet.job_word;
  job.address = packet.address;
  for (unsigned i = 0; i < 3; ++i) {
    job.t0[i] = numeric::float_to_fixed(packet.t0[i], p.format, p.conversion, stats);
    job.t1[i] = numeric::float_to_fixed(packet.t1[i], p.format, p.conversion, stats);
  }
  return job;
}

traversal_job job_manager::process(const job_packet& packet) {
  traversal_job job = convert(packet, params_, stats_.conversion);
  job.sequence = static_cast<std::uint32_t>(stats_.jobs++);
  return job;
}

void job_manager::trace(waveform& w) const {
  pipeline_unit::trace(w);
  w.add(stats_.jobs, std::string(name()) + ".jobs");
}

void job_manager::stats::describe(config::report& r) const {
  r.number("jobs", jobs, "jobs", "jobs accepted");
  r.group("float_to_fixed", [this](config::report& g) { conversion.describe(g); });
}

}  // namespace rtusim
