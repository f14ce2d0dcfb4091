#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <systemc>

#include "modules/config/error.h"
#include "modules/config/report.h"
#include "modules/formats/packets.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/scheduler/scheduler.h"
#include "modules/timing/channel.h"

namespace rtusim {

/// The figures of a job manager and its cores.
class bank_figures {
 public:
  virtual ~bank_figures() = default;
  virtual void describe_job_manager(config::report& r) const = 0;
  /// All cores in one, `WORD_core`, and each, `core_0` and on.
  virtual void describe_cores(config::report& r) const = 0;
  /// Of the words of the jobs.
  virtual numeric::float_to_fixed_stats conversion() const = 0;
};

/// Those of one kind: `conversion_of(const Jobs&)` is found by its argument.
template <class Jobs, class Core>
class figures_of final : public bank_figures {
 public:
  Jobs jobs;
  std::vector<Core> cores;

  explicit figures_of(std::string_view kind) : kind_(kind) {}

  void describe_job_manager(config::report& r) const override { jobs.describe(r); }
  void describe_cores(config::report& r) const override {
    Core all;
    for (const Core& core : cores) all += core;
    r.group(kind_ + "_core", [&](config::report& g) { all.describe(g); });
    for (std::size_t i = 0; i < cores.size(); ++i) r.group("core_" + std::to_string(i), [&](config::report& g) { cores[i].describe(g); });
  }
  numeric::float_to_fixed_stats conversion() const override { return conversion_of(jobs); }

 private:
  std::string kind_;
};

/// What banks of all kinds are built from.
struct bank_params {
  unsigned cores = 1;
  scheduler_params policy;
};

/// Cores of one kind with the job manager and the scheduler that feed them.
class core_bank {
 public:
  virtual ~core_bank() = default;

  virtual void bind(rv_in<job_packet>& jobs, sc_core::sc_vector<channel<traversal_result>>& results) = 0;
  /// The channel from the scheduler to a core. Its payload begins with a `core_job`.
  virtual channel_base& core_job_channel(unsigned core) = 0;

  /// Cycles from the one in which a job is accepted to the one in which it may be dispatched.
  virtual unsigned job_latency_cycles() const = 0;
  /// Cycles from the dispatch to the first in which a result of `cost` cycles may be offered, less the cost.
  virtual unsigned core_latency_cycles() const = 0;

  /// Of all cycles before the next edge.
  virtual std::unique_ptr<bank_figures> figures() = 0;
};

/// The part that all kinds have, with the way of a job in its own type.
template <class Job, class Manager, class Core>
class typed_bank : public core_bank {
 public:
  static_assert(std::is_base_of_v<core_job, Job>);

  template <class Make>
  typed_bank(std::string_view kind, const typename Manager::params& manager, const bank_params& p, Make make_core)
      : kind_(kind),
        job_manager_("job_manager", manager),
        scheduler_("scheduler", p.policy, p.cores),
        cores_("core", p.cores, make_core),
        core_job_("core_job", p.cores, [](const char* n, std::size_t) { return new channel<Job>(n); }) {
    const Job job{};
    RTU_CHECK(static_cast<const void*>(static_cast<const core_job*>(&job)), ==, static_cast<const void*>(&job));  // see `core_job_channel`
    job_manager_.out(pending_job_);
    scheduler_.job_in(pending_job_);
    for (unsigned i = 0; i < p.cores; ++i) {
      scheduler_.core_out[i](core_job_[i]);
      cores_[i].job_in(core_job_[i]);
    }
  }

  void bind(rv_in<job_packet>& jobs, sc_core::sc_vector<channel<traversal_result>>& results) override {
    job_manager_.in(jobs);
    for (unsigned i = 0; i < cores_.size(); ++i) cores_[i].result_out(results[i]);
  }
  channel_base& core_job_channel(unsigned core) override { return core_job_[core]; }
  std::unique_ptr<bank_figures> figures() override {
    auto f = std::make_unique<figures_of<typename Manager::stats, typename Core::stats>>(kind_);
    f->jobs = job_manager_.statistics();
    for (Core& core : cores_) f->cores.push_back(core.statistics());
    return f;
  }

 protected:
  sc_core::sc_vector<Core>& cores() { return cores_; }

 private:
  std::string kind_;
  Manager job_manager_;
  scheduler<Job> scheduler_;
  sc_core::sc_vector<Core> cores_;
  channel<Job> pending_job_{"pending_job"};
  sc_core::sc_vector<channel<Job>> core_job_;
};

}  // namespace rtusim
