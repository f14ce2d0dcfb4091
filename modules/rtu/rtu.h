#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "modules/bih_core/bih_core.h"
#include "modules/job_manager/job_manager.h"
#include "modules/job_manager/triangle_job_manager.h"
#include "modules/memory/memory.h"
#include "modules/result_manager/result_manager.h"
#include "modules/rtu/design.h"
#include "modules/scheduler/scheduler.h"
#include "modules/svo_core/svo_core.h"
#include "modules/triangle_unit/triangle_pipeline.h"

namespace rtusim {

/// What lies in the memories of an RTU: the words of octrees, or a hierarchy over triangles, as its cores need. They must outlive it.
struct model_view {
  const std::vector<std::uint32_t>* octrees = nullptr;
  const bih_memory* hierarchy = nullptr;

  model_view(const std::vector<std::uint32_t>& words) : octrees(&words) {}  // NOLINT: a view of either
  model_view(const bih_memory& h) : hierarchy(&h) {}                        // NOLINT
};

/// The units of an RTU up to its cores, for one kind of core.
template <class Job, class Manager, class Core>
struct rtu_front {
  template <class Make>
  rtu_front(const typename Manager::params& manager, const scheduler_params& policy, unsigned count, Make make_core)
      : job_manager_("job_manager", manager),
        scheduler_("scheduler", policy, count),
        cores("core", count, make_core),
        core_job("core_job", count, [](const char* n, std::size_t) { return new channel<Job>(n); }) {
    job_manager_.out(pending_job);
    scheduler_.job_in(pending_job);
    for (unsigned i = 0; i < count; ++i) {
      scheduler_.core_out[i](core_job[i]);
      cores[i].job_in(core_job[i]);
    }
  }

  Manager job_manager_;
  scheduler<Job> scheduler_;
  sc_core::sc_vector<Core> cores;
  channel<Job> pending_job{"pending_job"};
  sc_core::sc_vector<channel<Job>> core_job;
};

/// The ray tracing unit (Espe 2019, fig. 6.5 and app. C.1): jobs go in, results come out. Its cores are of one kind.
///
///     job_in -> job_manager -> scheduler -> N x core -> result_manager -> result_out
///                                             |
///                         svo: memory; bih: triangle_pipeline, one a core
class rtu : public sc_core::sc_module {
 public:
  rv_in<job_packet> job_in{"job_in"};
  rv_out<traversal_result> result_out{"result_out"};

  /// The model is of the kind that the cores need.
  rtu(const sc_core::sc_module_name& name, const design& d, const model_view& model);

  using svo_front = rtu_front<traversal_job, job_manager, svo_core>;
  using bih_front = rtu_front<triangle_job, triangle_job_manager, bih_core>;

  /// Calls `f` with the front of the cores' kind.
  template <class F>
  void visit(F&& f) {
    if (svo_)
      f(*svo_);
    else
      f(*bih_);
  }
  unsigned cores() const { return static_cast<unsigned>(core_result_.size()); }
  sc_core::sc_vector<channel<traversal_result>>& core_results() { return core_result_; }

  /// Cycles from the one in which a job is accepted to the one in which it may be dispatched.
  unsigned job_latency_cycles() const { return job_latency_cycles_; }
  /// Cycles from the dispatch to the first in which a result of `cost` clocks may be offered, less the cost.
  unsigned core_latency_cycles() const { return core_latency_cycles_; }

 private:
  std::unique_ptr<memory> memory_;
  std::unique_ptr<svo_front> svo_;
  std::vector<std::unique_ptr<triangle_pipeline>> pipelines_;
  std::unique_ptr<bih_front> bih_;
  result_manager result_manager_;
  sc_core::sc_vector<channel<traversal_result>> core_result_;
  unsigned job_latency_cycles_ = 0;
  unsigned core_latency_cycles_ = 0;
};

}  // namespace rtusim
