#pragma once

#include <memory>

#include "modules/core_bank/core_bank.h"
#include "modules/core_bank/core_kind.h"
#include "modules/result_manager/result_manager.h"
#include "modules/rtu/design.h"

namespace rtusim {

/// The ray tracing unit (Espe 2019, fig. 6.5 and app. C.1): jobs go in, results come out. Its cores are of one kind.
///
///     job_in -> job_manager -> scheduler -> N x core -> result_manager -> result_out
class rtu : public sc_core::sc_module {
 public:
  rv_in<job_packet> job_in{"job_in"};
  rv_out<traversal_result> result_out{"result_out"};

  /// `model`: what lies in the memories, of the kind that the cores need.
  rtu(const sc_core::sc_module_name& name, const design& d, const memory_contents& model);

  unsigned cores() const { return static_cast<unsigned>(core_result_.size()); }
  core_bank& bank() { return *bank_; }
  const core_bank& bank() const { return *bank_; }
  sc_core::sc_vector<channel<traversal_result>>& core_results() { return core_result_; }

 private:
  result_manager result_manager_;
  std::unique_ptr<core_bank> bank_;
  sc_core::sc_vector<channel<traversal_result>> core_result_;
};

}  // namespace rtusim
