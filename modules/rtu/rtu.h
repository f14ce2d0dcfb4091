#pragma once

#include <cstdint>
#include <vector>

#include "modules/job_manager/job_manager.h"
#include "modules/memory/memory.h"
#include "modules/result_manager/result_manager.h"
#include "modules/rtu/design.h"
#include "modules/scheduler/scheduler.h"
#include "modules/svo_core/svo_core.h"

namespace rtusim {

/// The ray tracing unit (Espe 2019, fig. 6.5 and app. C.1): jobs go in, results come out.
///
///     job_in -> job_manager -> scheduler -> N x core -> result_manager -> result_out
///                                             |
///                                           memory
class rtu : public sc_core::sc_module {
 public:
  rv_in<job_packet> job_in{"job_in"};
  rv_out<traversal_result> result_out{"result_out"};

  /// `image`: the words of the model memory; they must outlive the unit.
  rtu(const sc_core::sc_module_name& name, const design& d, const std::vector<std::uint32_t>& image);

  job_manager& jobs() { return job_manager_; }
  sc_core::sc_vector<svo_core>& cores() { return cores_; }
  channel<traversal_job>& pending_job() { return pending_job_; }
  sc_core::sc_vector<channel<traversal_job>>& core_jobs() { return core_job_; }
  sc_core::sc_vector<channel<traversal_result>>& core_results() { return core_result_; }

 private:
  job_manager job_manager_;
  scheduler<traversal_job> scheduler_;
  memory memory_;
  sc_core::sc_vector<svo_core> cores_;
  result_manager result_manager_;
  channel<traversal_job> pending_job_{"pending_job"};
  sc_core::sc_vector<channel<traversal_job>> core_job_;
  sc_core::sc_vector<channel<traversal_result>> core_result_;
};

}  // namespace rtusim
