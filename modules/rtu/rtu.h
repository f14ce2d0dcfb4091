#pragma once

#include <memory>

#include "modules/core_bank/core_bank.h"
#include "modules/core_bank/core_kind.h"
#include "modules/rtu/design.h"

namespace rtusim {

/// The ray tracing unit (Espe 2019, fig. 6.5 and app. C.1): jobs go in, results come out. Its cores are of one kind.
///
///     job_in -> job_manager -> scheduler -> N x core -> result_manager -> results
class rtu : public sc_core::sc_module {
 public:
  rv_in<job_packet> job_in{"job_in"};

  /// `model`: what lies in the memories, of the kind that the cores need.
  rtu(const sc_core::sc_module_name& name, const design& d, const memory_contents& model)
      : sc_module(name), bank_(d.kind().build({d.rtu.cores, d.scheduler_, d.result_manager_}, model)) {
    bank_->bind(job_in);
  }

  core_bank& bank() { return *bank_; }
  const core_bank& bank() const { return *bank_; }

 private:
  std::unique_ptr<core_bank> bank_;
};

}  // namespace rtusim
