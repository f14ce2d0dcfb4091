#pragma once

#include "modules/timing/channel.h"
#include "modules/timing/unit.h"

namespace rtusim {

/// A unit through which a transfer passes in the same cycle, to one of N outputs: a scheduler, an arbiter. It stores nothing.
///
/// Its input's ready is a function of which outputs are ready; an output's valid is the input's, where the policy points.
/// The outputs' channels are neither booked nor solved: when the input fires, the junction names the output that fires with
/// it. So the work grows with the transfers, not with N. The input's valid must be a plain "from some cycle on", and so must
/// the outputs' ready.
class junction : public unit {
 public:
  /// Cycles so far in which output `which` was valid. The input's are settled.
  virtual std::uint64_t valid_cycles(unsigned which) = 0;
  /// Whether the input, if valid in cycle c, is shown to output `which`.
  virtual bool points_at(unsigned which, cycle c) const = 0;

 protected:
  using unit::unit;

  /// Called once by a derived `connect`.
  void own_input(channel_base& input) { input.downstream_ = this; }
  void own_output(channel_base& output, unsigned which) {
    output.upstream_ = this;
    output.output_ = which;
  }

  /// The consumer behind output `which` is ready from the next cycle on, or no longer: revise the input's ready.
  virtual void output_ready(unsigned which, bool ready) = 0;
  /// The input was valid in the cycles [from, to), in which the registers did not change.
  virtual void input_valid(cycle from, cycle to) = 0;
  /// The input fires in cycle c: the output that fires with it. The registers move here, as there is nothing else that moves them.
  virtual channel_base& pass(cycle c) = 0;
  void edge() final {}

 private:
  friend class channel_base;
  friend class clock_domain;
};

}  // namespace rtusim
