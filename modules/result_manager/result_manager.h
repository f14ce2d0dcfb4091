#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "modules/result_manager/result_manager_params.h"
#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/rotating_select.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"

namespace rtusim {

/// Collects the cores' results in a buffer each and sends them out one by one (Espe 2019, sec. 6.2.5 and app. C.5).
///
/// Timing: an empty buffer takes its core's result at the edge at which that is valid. A select turns by one every cycle; the buffer
/// that it points at is offered if it is full, and empty again from the edge after the transfer on. Order `as_finished`.
template <class Result>
class result_manager final : public unit {
 public:
  using params = result_manager_params;

  sc_core::sc_vector<rv_in<Result>> core_in;
  rv_out<Result> result_out{"result_out"};

  result_manager(const sc_core::sc_module_name& name, const params& p, unsigned cores);

  void arrives(channel_base& in) override;
  void leaves(channel_base&) override;
  const Result& payload_at(cycle c) const;
  std::optional<unit_timing> timing() const override;
  const result_manager_stats& statistics() const { return stats_; }
  std::unique_ptr<unit_figures> figures() override { return as_figures(stats_); }

 private:
  void connect() override;
  void reset() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  void offer_result(bool taken);
  unsigned selected(cycle c) const;
  unsigned select() const { return selected(next_edge()); }

  bool valid_withdrawn_;  // with one buffer the select has nowhere to turn to
  rotating_select full_;  // the select, and which buffers are full
  std::vector<Result> buffers_;
  std::vector<cycle> came_;  // when each took its result
  result_manager_stats stats_;
  cycle offered_from_ = never;  // where an offer stays: since when the select stands, and where
  unsigned offered_ = 0;
  std::vector<std::uint8_t> is_full_;  // as a waveform shows it
};

template <class Result>
result_manager<Result>::result_manager(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : unit(name),
      core_in("core_in", cores),
      valid_withdrawn_(p.valid_withdrawn && cores > 1),
      full_(cores),
      buffers_(cores),
      came_(cores),
      is_full_(cores) {}

template <class Result>
void result_manager<Result>::connect() {
  for (unsigned i = 0; i < core_in.size(); ++i) core_in[i]->set_input_index(i);
  if (valid_withdrawn_) result_out->drive_from(*this);
}

template <class Result>
void result_manager<Result>::reset() {
  for (auto& in : core_in) in->offer_ready(offer::always_from(0));
  result_out->offer_valid(offer::none());
}

template <class Result>
std::optional<unit_timing> result_manager<Result>::timing() const {
  unit_timing t;
  t.latency_cycles = 1;
  t.interval_cycles = 2;  // where the select stands at the buffer; it comes round once in as many cycles as there are cores
  t.capacity = 1;
  return t;
}

template <class Result>
unsigned result_manager<Result>::selected(cycle c) const {
  return valid_withdrawn_ || c < offered_from_ ? full_.selected(c) : offered_;
}

template <class Result>
const Result& result_manager<Result>::payload_at(cycle c) const {
  return buffers_[selected(c)];
}

template <class Result>
void result_manager<Result>::arrives(channel_base& in) {
  const unsigned core = in.input_index();
  if (valid_withdrawn_) result_out->settle_valid();
  buffers_[core] = static_cast<channel<Result>&>(in).data();
  came_[core] = now();
  full_.set_line(core, true);
  is_full_[core] = true;
  offer_result(false);
}

template <class Result>
void result_manager<Result>::leaves(channel_base&) {
  const unsigned core = selected(now());
  stats_.results.add(now() - came_[core]);
  full_.set_line(core, false);
  is_full_[core] = false;
  core_in[core]->offer_ready(offer::always_from(now() + 1));
  if (!valid_withdrawn_) full_.select(core + 1 < full_.lines() ? core + 1 : 0, now() + 1);
  offer_result(true);
}

template <class Result>
void result_manager<Result>::offer_result(bool taken) {
  if (valid_withdrawn_) {
    result_out->offer_valid(offer::in(full_));
  } else if (taken || offered_from_ > now()) {
    const auto first = full_.next_place(now() + 1);
    offered_from_ = first.when;
    offered_ = first.line;
    if (offered_from_ == never) return;
    result_out->drive(buffers_[offered_]);
    result_out->offer_valid(offer::always_from(offered_from_));
  }
}

template <class Result>
bool result_manager<Result>::level(const channel_base& port) const {
  if (&port == result_out.operator->()) return full_.line(selected(next_edge()));
  for (unsigned i = 0; i < core_in.size(); ++i)
    if (&port == core_in[i].operator->()) return !full_.line(i);
  return false;
}

template <class Result>
void result_manager<Result>::trace(waveform& w) const {
  const std::string n = name();
  w.add_from<&result_manager::select>(*this, n + ".select", 16);
  for (unsigned i = 0; i < is_full_.size(); ++i) w.add(is_full_[i], n + ".full_" + std::to_string(i), 1);
}

}  // namespace rtusim
