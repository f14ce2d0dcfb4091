#pragma once

#include <utility>
#include <vector>

#include "modules/timing/channel.h"
#include "modules/timing/unit.h"

namespace rtusim {

/// A unit through which a transfer passes in the same cycle, to one of N outputs: a scheduler, an arbiter. It stores nothing.
///
/// Its input's ready is a function of which outputs are ready; an output's valid is the input's, where the policy points.
/// The outputs' channels are neither booked nor solved: as the input transfers (`arrives`), the junction settles its valid and passes the
/// payload to the output that transfers with it. So the work grows with the transfers, not with N. The input's valid must be a plain "from
/// some cycle on", and so must the outputs' ready.
class junction : public unit {
 public:
  /// Cycles before the next edge in which output `which` was valid.
  virtual std::uint64_t valid_cycles(unsigned which) const = 0;
  /// Whether the input, if valid in cycle c, is shown to output `which`.
  virtual bool points_at(unsigned which, cycle c) const = 0;

 protected:
  using unit::unit;

  /// Called once by a derived `connect`.
  void own_input(channel_base& input) {
    input_ = &input;
    input.downstream_ = this;
  }
  void own_output(channel_base& output, unsigned which) {
    output.upstream_ = this;
    output.output_ = which;
  }
  /// To be called last as the input transfers: lets in what was heard at this edge before.
  void end_transfer() {
    for (const auto& [which, ready] : late_) output_ready(which, ready);
    late_.clear();
  }

  /// The consumer behind output `which` is ready from the next cycle on, or no longer: revise the input's ready.
  virtual void output_ready(unsigned which, bool ready) = 0;
  /// The input was valid in the cycles [from, to), in which the registers did not change. Told as an offer of the input ends.
  virtual void input_valid(cycle from, cycle to) = 0;

 private:
  friend class channel_base;

  /// Which output the input's transfer of this edge goes to depends on who was ready before the edge: who becomes so at it has to wait.
  void hear(unsigned which, bool ready) {
    if (input_->is_due())
      late_.emplace_back(which, ready);
    else
      output_ready(which, ready);
  }

  channel_base* input_ = nullptr;
  std::vector<std::pair<unsigned, bool>> late_;
};

}  // namespace rtusim
