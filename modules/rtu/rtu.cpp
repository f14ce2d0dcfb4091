#include "modules/rtu/rtu.h"

#include <string>

#include "modules/config/error.h"

namespace rtusim {

rtu::rtu(const sc_core::sc_module_name& name, const design& d, const model_view& model)
    : sc_module(name),
      result_manager_("result_manager", d.result_manager_, d.rtu.cores),
      core_result_("core_result") {
  switch (d.rtu.core) {
    case rtu_params::core_kind::svo: {
      RTU_CHECK(model.octrees != nullptr, ==, true);
      memory_ = std::make_unique<memory>("memory", d.memory_, *model.octrees);
      const svo_core_params params = d.svo_core_params_with_format();
      svo_ = std::make_unique<svo_front>(d.job_manager_params(), d.scheduler_, d.rtu.cores, [&](const char* n, std::size_t i) {
        return new svo_core(n, params, static_cast<unsigned>(i));
      });
      for (auto& core : svo_->cores) core.memory_port(*memory_);
      job_latency_cycles_ = job_manager::latency_cycles;
      core_latency_cycles_ = 1;
      break;
    }
    case rtu_params::core_kind::bih: {
      RTU_CHECK(model.hierarchy != nullptr, ==, true);
      const bih_core_params params = d.bih_core_params_with_widths();
      const triangle_job_manager::params jobs{d.quantisation_, model.hierarchy->corner};
      bih_ = std::make_unique<bih_front>(jobs, d.scheduler_, d.rtu.cores, [&](const char* n, std::size_t i) {
        return new bih_core(n, params, *model.hierarchy, static_cast<unsigned>(i));
      });
      for (unsigned i = 0; i < d.rtu.cores; ++i) {
        pipelines_.push_back(std::make_unique<triangle_pipeline>(("triangle_pipeline_" + std::to_string(i)).c_str(),
                                                                 d.triangle_unit_params_with_words(), model.hierarchy->triangles));
        bih_->cores[i].intersector_port(*pipelines_.back());
      }
      job_latency_cycles_ = triangle_job_manager::stages_of(jobs);
      core_latency_cycles_ = pipelines_.front()->latency_cycles() + 1;
      break;
    }
  }
  core_result_.init(d.rtu.cores, [](const char* n, std::size_t) { return new channel<traversal_result>(n); });
  visit([this](auto& front) {
    front.job_manager_.in(job_in);
    for (unsigned i = 0; i < front.cores.size(); ++i) front.cores[i].result_out(core_result_[i]);
  });
  for (unsigned i = 0; i < d.rtu.cores; ++i) result_manager_.core_in[i](core_result_[i]);
  result_manager_.result_out(result_out);
}

}  // namespace rtusim
