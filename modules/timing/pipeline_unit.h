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
  void arrives(channel_base&) final {
    const bool is_oldest = pipeline_.empty();
    process(in->data(), pipeline_.enter(now()));
    offer_room();
    if (is_oldest) offer_output();
  }
  void leaves(channel_base&) final {
    pipeline_.leave(now());
    const bool is_last = pipeline_.empty();
    if (!in->pass()) offer_room();
    if (!is_last) offer_output();
  }
  std::optional<unit_timing> timing() const final {
    unit_timing t;
    t.latency_cycles = stages();
    t.interval_cycles = pipeline_.interval();
    t.capacity = (stages() - 1) / t.interval_cycles + 1;
    t.ready_passes = true;
    return t;
  }

 protected:
  /// 1 <= interval <= stages.
  pipeline_unit(const sc_core::sc_module_name& name, unsigned stages, unsigned interval = 1) : unit(name), pipeline_(stages, interval) {}

  /// The work of all stages, done as the payload enters: nothing depends on when.
  virtual void process(const In& payload, Out& result) = 0;

  void trace(waveform& w) const override {
    w.add_from<&pipeline_unit::stage_valid>(*this, std::string(name()) + ".stage_valid", std::min(stages(), 64u));
  }

 private:
  void connect() override { in->ready_through(*out.operator->()); }
  void reset() override {
    in->offer_ready(offer::always_from(0));
    out->offer_valid(offer::none());
  }
  /// Ready from when the interval is over until the oldest payload is at the output; from then on in the cycle in which that is taken.
  void offer_room() { in->offer_ready(offer::always_from(pipeline_.room_from()), pipeline_.output_from()); }
  void offer_output() {
    out->drive(pipeline_.output());
    out->offer_valid(offer::always_from(pipeline_.output_from()));
  }
  bool level(const channel_base& port) const override {
    const bool at_output = next_edge() >= pipeline_.output_from();
    if (&port == out.operator->()) return at_output;
    return (at_output ? out->ready_level() : true) && std::min(next_edge(), pipeline_.output_from()) >= pipeline_.room_from();
  }
  std::uint64_t stage_valid() const { return pipeline_.valid_bits(next_edge()); }

  stall_pipeline<Out> pipeline_;
};

}  // namespace rtusim
