#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/stall_pipeline.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"

namespace rtusim {

/// A unit that is a pipeline whose stages move together; `process` says what becomes of a payload.
///
/// Timing: what is accepted at edge e is offered from edge e + stages on. All stages advance when the output is taken or
/// nothing is offered; ready is the same term, so it follows the consumer's within the cycle. Bubbles are not squeezed out. With an
/// interval above 1 the first stage takes something again only `interval` moves after the last time.
template <class In, class Out>
class pipeline_unit : public unit {
 public:
  rv_in<In> in{"in"};
  rv_out<Out> out{"out"};

  unsigned stages() const { return pipeline_.stages(); }
  std::optional<unit_timing> timing() const final {
    unit_timing t;
    t.latency_cycles = stages();
    t.interval_cycles = static_cast<unsigned>(interval_);
    t.capacity = (stages() - 1) / t.interval_cycles + 1;
    t.ready_passes = true;
    return t;
  }

 protected:
  /// 1 <= interval <= stages.
  pipeline_unit(const sc_core::sc_module_name& name, unsigned stages, unsigned interval = 1)
      : unit(name), pipeline_(stages), interval_(interval) {
    moves_when_idle();
  }

  /// The work of all stages, done as the payload enters: nothing depends on when.
  virtual void process(const In& payload, Out& result) = 0;

  void trace(waveform& w) const override { w.add(shown_valid_bits_, std::string(name()) + ".stage_valid", std::min(stages(), 64u)); }

 private:
  /// Ready: from when the interval is over until the oldest payload is at the output; from then on in the cycle in which that is taken.
  class flow_through final : public pattern {
   public:
    explicit flow_through(const pipeline_unit& owner) : owner_(owner) {}
    cycle next(cycle c) const override {
      const cycle first = std::max(c, owner_.room_from_);
      if (first < owner_.output_from_) return first;
      const cycle fires = owner_.out->fires_at();
      return fires >= c && owner_.room_at_output() ? fires : never;
    }
    std::uint64_t count(cycle from, cycle to) const override {
      // The unit settles at every transfer of its output, so at most the last one lies in the interval.
      const cycle taken = owner_.out->last_fire();
      const bool one = taken != never && taken >= std::max(from, owner_.output_from_) && taken < to && owner_.room_at_output();
      return cycles_from(owner_.room_from_, from, std::min(to, owner_.output_from_)) + one;
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
    const bool entered = in->fired();
    const bool moved = pipeline_.advance(taken);
    if (entered) process(in->data(), pipeline_.enter());
    const cycle from = pipeline_.output_from(now() + 1);
    if (!moved || (from == output_from_ && !(entered && interval_ > 1))) return;
    in->settle_ready();
    if (interval_ > 1) room_from_ = now() + 1 + (interval_ - std::min<cycle>(interval_, pipeline_.since_entry()));
    in->offer_ready(offer::in(ready_));
    if (from == output_from_) return;
    output_from_ = from;
    if (!pipeline_.empty()) out->drive(pipeline_.output());
    out->offer_valid(offer::always_from(from));
  }
  void idle(cycle n) override { pipeline_.idle(n); }
  void settle_registers() override { shown_valid_bits_ = pipeline_.valid_bits(); }
  bool level(const channel_base& port) const override {
    if (&port == out.operator->()) return pipeline_.output_valid();
    return pipeline_.since_entry() >= interval_ && (!pipeline_.output_valid() || out->ready_level());
  }
  /// Whether the interval is over when the oldest payload is at the output.
  bool room_at_output() const { return room_from_ <= output_from_; }

  stall_pipeline<Out> pipeline_;
  cycle interval_;
  cycle output_from_ = never;  // when the oldest payload is at the output
  cycle room_from_ = 0;        // when the interval is over
  flow_through ready_{*this};
  std::uint64_t shown_valid_bits_ = 0;
};

}  // namespace rtusim
