#include "modules/job_manager/job_manager.h"

namespace rtusim {

job_manager::job_manager(const sc_core::sc_module_name& name, const params& p)
    : pipeline_unit(name, latency_cycles), converter_(p.format, p.conversion) {}

void job_manager::process(const job_packet& packet, traversal_job& job) {
  if (elsewhere_) {
    job.job_word = packet.job_word;
    job.address = packet.address;
  } else {
    convert(packet, converter_, stats_.conversion, job);
  }
  job.sequence = static_cast<std::uint32_t>(stats_.jobs++);
}

job_manager::stats job_manager::statistics() const {
  stats s = stats_;
  if (elsewhere_) s.conversion = elsewhere_(s.jobs);
  return s;
}

void job_manager::trace(waveform& w) const {
  pipeline_unit::trace(w);
  w.add(stats_.jobs, std::string(name()) + ".jobs");
}

job_manager::stats& job_manager::stats::operator+=(const stats& other) {
  jobs += other.jobs;
  conversion += other.conversion;
  return *this;
}

void job_manager::stats::describe(config::report& r) const {
  r.number("jobs", jobs, "jobs", "jobs accepted");
  r.group("float_to_fixed", [this](config::report& g) { conversion.describe(g); });
}

}  // namespace rtusim
