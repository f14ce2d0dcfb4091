#pragma once

#include <memory>
#include <vector>

#include <systemc>

#include "modules/formats/packets.h"
#include "modules/result_manager/result_manager_params.h"
#include "modules/scheduler/scheduler_params.h"
#include "modules/timing/channel.h"
#include "modules/timing/unit_timing.h"

namespace rtusim {

/// What banks of all kinds are built from.
struct bank_params {
  unsigned cores = 1;
  scheduler_params policy;
  result_manager_params results;
};

/// Cores of one kind with the job manager and the scheduler that feed them, and the result manager behind them.
class core_bank {
 public:
  virtual ~core_bank() = default;

  virtual void bind(rv_in<job_packet>& jobs) = 0;
  /// The channel that results leave by, bound to the bank: a child of the module that is being constructed. Its payload begins with a
  /// `traversal_result`, as do those from the cores; those from the scheduler to the cores begin with a `core_job`.
  virtual std::unique_ptr<channel_base> make_result_channel(const char* name) = 0;
  virtual channel_base& core_job_channel(unsigned core) = 0;
  virtual channel_base& core_result_channel(unsigned core) = 0;
  virtual unsigned cores() const = 0;
  /// These jobs will come, in this order, and nobody looks at them on their way: a bank may work ahead of the clock. They must outlive it.
  virtual void expect(const std::vector<job_packet>&) {}

  /// The contracts of the job manager and of the cores, of which one is like the other.
  virtual unit_timing job_timing() const = 0;
  virtual unit_timing core_timing() const = 0;
};

}  // namespace rtusim
