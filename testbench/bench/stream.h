#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"
#include "testbench/bench/lfsr.h"
#include "testbench/bench/surroundings.h"

namespace rtusim {

/// Offers the items of a list one after the other. Regimes:
/// - always: each item at once;
/// - gap: `gap_cycles` cycles after a transfer without an offer;
/// - paced: an item is first offered `interval_cycles` after the one before was, or after that one's transfer if later;
/// - lfsr: in the cycles in which bit 0 of the register is 1 (the offer may so be taken back).
template <class T>
class stream_source final : public unit {
  using regime = source_params::regime;

 public:
  rv_out<T> out{"out"};

  /// `items` must outlive the source.
  stream_source(const sc_core::sc_module_name& name, const source_params& p, const std::vector<T>& items)
      : unit(name), params_(p), items_(items) {
    if (p.valid == source_params::regime::lfsr) random_ = std::make_unique<lfsr>(p.seed);
  }

  std::size_t sent() const { return sent_; }
  void leaves(channel_base&) override {
    ++sent_;
    switch (params_.valid) {
      case regime::always:
      case regime::lfsr: from_ = now() + 1; break;
      case regime::gap: from_ = now() + 1 + params_.gap_cycles; break;
      case regime::paced: from_ = std::max(from_ + params_.interval_cycles, now() + 1); break;
    }
    publish();
  }

 private:
  void reset() override {
    from_ = 0;
    publish();
  }
  void publish() {
    if (sent_ == items_.size()) return;
    out->drive(items_[sent_]);
    out->offer_valid(random_ ? offer::in(*random_, from_) : offer::always_from(from_));
  }
  bool level(const channel_base&) const override {
    const cycle c = next_edge();
    return sent_ < items_.size() && c >= from_ && (!random_ || (random_->state(c) & 1) != 0);
  }
  void trace(waveform& w) const override { w.add(sent_, std::string(name()) + ".sent"); }

  source_params params_;
  const std::vector<T>& items_;
  std::unique_ptr<lfsr> random_;
  std::size_t sent_ = 0;
  cycle from_ = 0;  // the present item is offered from here on
};

/// Takes items and ends the simulation after the last one expected.
template <class Port>
class port_sink final : public unit {
 public:
  Port in{"in"};

  port_sink(const sc_core::sc_module_name& name, const sink_params& p, std::uint64_t expected)
      : unit(name), params_(p), expected_(expected) {
    if (p.ready == sink_params::regime::lfsr) random_ = std::make_unique<lfsr>(p.seed);
  }

  std::uint64_t received() const { return received_; }
  void arrives(channel_base&) override {
    if (++received_ == expected_) domain().stop();
    publish(now() + 1);
  }

 private:
  using regime = sink_params::regime;

  void reset() override { publish(0); }
  void publish(cycle from) {
    if (params_.ready == regime::blocked) return;
    in->offer_ready(random_ ? offer::in(*random_, from) : offer::always_from(from));
  }
  bool level(const channel_base&) const override {
    return random_ ? (random_->state(next_edge()) & 1) != 0 : params_.ready == regime::always;
  }
  void trace(waveform& w) const override { w.add(received_, std::string(name()) + ".received"); }

  sink_params params_;
  std::uint64_t expected_;
  std::unique_ptr<lfsr> random_;
  std::uint64_t received_ = 0;
};

template <class T>
using stream_sink = port_sink<rv_in<T>>;
using any_sink = port_sink<rv_in_any>;

}  // namespace rtusim
