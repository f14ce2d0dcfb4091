#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include <systemc>

#include "modules/config/error.h"
#include "modules/core_bank/core_bank.h"
#include "modules/result_manager/result_manager.h"
#include "modules/scheduler/scheduler.h"
#include "modules/timing/link.h"

namespace rtusim {

/// The part that all kinds have, with the way of a job and of a result in their own types: job manager, scheduler, cores, result manager.
/// `Core` has `job_type` and `result_type`, and the ports `job_in` and `result_out`.
template <class Manager, class Core>
class typed_bank : public core_bank {
 public:
  using job_type = typename Core::job_type;
  using result_type = typename Core::result_type;
  using job_link = link<job_type, scheduler<job_type>, Core>;
  using result_link = link<result_type, Core, result_manager<result_type>>;
  static_assert(std::is_base_of_v<core_job, job_type> && std::is_base_of_v<traversal_result, result_type>);

  template <class Make>
  typed_bank(const typename Manager::params& manager, const bank_params& p, Make make_core)
      : job_manager_("job_manager", manager),
        scheduler_("scheduler", p.policy, p.cores),
        cores_("core", p.cores, make_core),
        result_manager_("result_manager", p.results, p.cores),
        core_job_("core_job", p.cores, [](const char* n, std::size_t) { return new job_link(n); }),
        core_result_("core_result", p.cores, [](const char* n, std::size_t) { return new result_link(n); }) {
    check_begins_with<core_job, job_type>();
    check_begins_with<traversal_result, result_type>();
    job_manager_.out(pending_job_);
    scheduler_.job_in(pending_job_);
    for (unsigned i = 0; i < p.cores; ++i) {
      scheduler_.core_out[i](core_job_[i]);
      cores_[i].job_in(core_job_[i]);
      cores_[i].result_out(core_result_[i]);
      result_manager_.core_in[i](core_result_[i]);
    }
  }

  void bind(rv_in<job_packet>& jobs) override { job_manager_.in(jobs); }
  std::unique_ptr<channel_base> make_result_channel(const char* name) override {
    auto made = std::make_unique<channel<result_type>>(name);
    result_manager_.result_out(*made);
    return made;
  }
  channel_base& core_job_channel(unsigned core) override { return core_job_[core]; }
  channel_base& core_result_channel(unsigned core) override { return core_result_[core]; }
  unsigned cores() const override { return static_cast<unsigned>(cores_.size()); }
  unit_timing job_timing() const override { return job_manager_.timing().value(); }
  unit_timing core_timing() const override { return cores_[0].timing().value(); }

 protected:
  Manager& manager() { return job_manager_; }
  Core& core(unsigned i) { return cores_[i]; }

 private:
  template <class Part, class Whole>
  static void check_begins_with() {
    const Whole whole{};
    RTU_CHECK(static_cast<const void*>(static_cast<const Part*>(&whole)), ==, static_cast<const void*>(&whole));
  }

  Manager job_manager_;
  scheduler<job_type> scheduler_;
  sc_core::sc_vector<Core> cores_;
  result_manager<result_type> result_manager_;
  link<job_type, Manager, scheduler<job_type>> pending_job_{"pending_job"};
  sc_core::sc_vector<job_link> core_job_;
  sc_core::sc_vector<result_link> core_result_;
};

}  // namespace rtusim
