#pragma once

#include <string>

#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/stall_pipeline.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"

namespace rtusim {

/// A unit that is a pipeline whose stages move together; `process` says what becomes of a payload.
///
/// Timing: what is accepted at edge e is offered from edge e + Stages on. All stages advance when the output is taken or
/// nothing is offered; ready is the same term, so it follows the consumer's within the clock. Bubbles are not squeezed out.
template <class In, class Out, unsigned Stages>
class pipeline_unit : public unit {
 public:
  rv_in<In> in{"in"};
  rv_out<Out> out{"out"};

  static constexpr unsigned stages = Stages;

 protected:
  explicit pipeline_unit(const sc_core::sc_module_name& name) : unit(name) { moves_when_idle(); }

  /// The work of all stages, done as the payload enters: nothing depends on when.
  virtual Out process(const In& payload) = 0;

  void trace(waveform& w) const override { w.add(shown_valid_bits_, std::string(name()) + ".stage_valid", Stages); }

 private:
  /// Ready: until the oldest payload is at the output; from then on in the cycle in which that is taken.
  class flow_through final : public pattern {
   public:
    explicit flow_through(const pipeline_unit& owner) : owner_(owner) {}
    cycle next(cycle c) const override {
      if (c < owner_.output_from_) return c;
      const cycle fires = owner_.out->fires_at();
      return fires >= c ? fires : never;
    }
    std::uint64_t count(cycle from, cycle to) const override {
      // The unit settles at every transfer of its output, so at most the last one lies in the interval.
      const cycle taken = owner_.out->last_fire();
      const bool one = taken != never && taken >= std::max(from, owner_.output_from_) && taken < to;
      return (from < owner_.output_from_ ? std::min(to, owner_.output_from_) - from : 0) + one;
    }

   private:
    const pipeline_unit& owner_;
  };

  void connect() override { domain().depends(*in.operator->(), *out.operator->()); }
  void reset() override {
    in->offer_ready(offer::in(ready_));
    out->offer_valid(offer::none());
  }
  void edge() override {
    const bool taken = out->fired();
    if (in->fired()) {
      const Out entering = process(in->data());
      pipeline_.edge(taken, &entering);
    } else {
      pipeline_.edge(taken, nullptr);
    }
    const cycle from = pipeline_.output_from(now() + 1);
    const bool stays = output_from_ <= now() && !taken;  // what is at the output and not taken changes nothing
    if (from == output_from_ || stays) return;
    in->settle_ready();
    output_from_ = from;
    in->offer_ready(offer::in(ready_));
    if (!pipeline_.empty()) out->drive(pipeline_.output());
    out->offer_valid(offer::always_from(from));
  }
  void idle(cycle n) override { pipeline_.idle(n); }
  void settle_registers() override { shown_valid_bits_ = pipeline_.valid_bits(); }
  bool level(const channel_base& port) const override {
    return &port == out.operator->() ? pipeline_.output_valid() : !pipeline_.output_valid() || out->ready_level();
  }

  stall_pipeline<Out, Stages> pipeline_;
  cycle output_from_ = never;  // when the oldest payload is at the output
  flow_through ready_{*this};
  std::uint32_t shown_valid_bits_ = 0;
};

}  // namespace rtusim
