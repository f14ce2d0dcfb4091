#include "modules/job_manager/triangle_job_manager.h"

namespace rtusim {

triangle_job_manager::triangle_job_manager(const sc_core::sc_module_name& name, const params& p)
    : pipeline_unit(name, stages_of(p)), setup_(p.words, p.corner) {}

void triangle_job_manager::process(const job_packet& packet, triangle_job& job) {
  setup_(packet, stats_.setup, job);
  job.sequence = static_cast<std::uint32_t>(stats_.jobs++);
}

void triangle_job_manager::trace(waveform& w) const {
  pipeline_unit::trace(w);
  w.add(stats_.jobs, std::string(name()) + ".jobs");
}

triangle_job_manager::stats& triangle_job_manager::stats::operator+=(const stats& other) {
  jobs += other.jobs;
  setup += other.setup;
  return *this;
}

void triangle_job_manager::stats::describe(config::report& r) const {
  r.number("jobs", jobs, "jobs", "jobs accepted");
  setup.describe(r);
}

}  // namespace rtusim
