#include "modules/rtu/rtu.h"

namespace rtusim {

rtu::rtu(const sc_core::sc_module_name& name, const design& d, const std::vector<std::uint32_t>& image)
    : sc_module(name),
      job_manager_("job_manager", d.job_manager_params()),
      scheduler_("scheduler", d.scheduler_, d.rtu.cores),
      memory_("memory", d.memory_, image),
      cores_("core"),
      result_manager_("result_manager", d.result_manager_, d.rtu.cores),
      core_job_("core_job", d.rtu.cores, [](const char* n, std::size_t) { return new channel<traversal_job>(n); }),
      core_result_("core_result", d.rtu.cores, [](const char* n, std::size_t) { return new channel<traversal_result>(n); }) {
  const svo_core_params core_params = d.svo_core_params_with_format();
  cores_.init(d.rtu.cores, [&](const char* n, std::size_t i) { return new svo_core(n, core_params, static_cast<unsigned>(i)); });

  job_manager_.in(job_in);
  job_manager_.out(pending_job_);
  scheduler_.job_in(pending_job_);
  for (unsigned i = 0; i < d.rtu.cores; ++i) {
    scheduler_.core_out[i](core_job_[i]);
    cores_[i].job_in(core_job_[i]);
    cores_[i].memory_port(memory_);
    cores_[i].result_out(core_result_[i]);
    result_manager_.core_in[i](core_result_[i]);
  }
  result_manager_.result_out(result_out);
}

}  // namespace rtusim
