#include "modules/rtu/rtu.h"

namespace rtusim {

rtu::rtu(const sc_core::sc_module_name& name, const design& d, const memory_contents& model)
    : sc_module(name), result_manager_("result_manager", d.result_manager_, d.rtu.cores), core_result_("core_result") {
  bank_ = d.kind().build({d.rtu.cores, d.scheduler_}, model);
  core_result_.init(d.rtu.cores, [](const char* n, std::size_t) { return new channel<traversal_result>(n); });
  bank_->bind(job_in, core_result_);
  for (unsigned i = 0; i < d.rtu.cores; ++i) result_manager_.core_in[i](core_result_[i]);
  result_manager_.result_out(result_out);
}

}  // namespace rtusim
