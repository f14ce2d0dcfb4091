#include "modules/result_manager/result_manager.h"

#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"

namespace rtusim {

result_manager::result_manager(const sc_core::sc_module_name& name, const params& p, unsigned cores)
    : unit(name),
      core_in("core_in", cores),
      valid_withdrawn_(p.valid_withdrawn && cores > 1),
      full_(cores),
      buffers_(cores),
      shown_full_(cores) {}

void result_manager::connect() {
  for (unsigned i = 0; i < core_in.size(); ++i) core_in[i]->report_arrivals_as(i);
  result_out->drive_from(*this);
}

void result_manager::reset() {
  for (auto& in : core_in) in->offer_ready(offer::always_from(0));
  result_out->offer_valid(offer::none());
}

unsigned result_manager::selected(cycle c) const { return full_.selected(valid_withdrawn_ ? c : std::min(c, offered_from_)); }

const traversal_result& result_manager::payload_at(cycle c) const { return buffers_[selected(c)]; }

void result_manager::edge() {
  const bool taken = result_out->fired();
  if (!taken && arrivals().empty()) return;
  result_out->settle_valid();
  if (taken) {
    const unsigned core = selected(now());
    full_.set_line(core, false);
    core_in[core]->offer_ready(offer::always_from(now() + 1));
    if (!valid_withdrawn_) full_.select(core + 1 < full_.lines() ? core + 1 : 0, now() + 1);
  }
  for (const unsigned core : arrivals()) {
    buffers_[core] = core_in[core]->data();
    full_.set_line(core, true);
    core_in[core]->offer_ready(offer::none());
  }
  if (valid_withdrawn_) {
    result_out->offer_valid(offer::in(full_));
  } else if (taken || offered_from_ > now()) {
    offered_from_ = full_.next(now() + 1);
    result_out->offer_valid(offer::always_from(offered_from_));
  }
}

bool result_manager::level(const channel_base& port) const {
  if (&port == result_out.operator->()) return full_.line(selected(next_edge()));
  for (unsigned i = 0; i < core_in.size(); ++i)
    if (&port == core_in[i].operator->()) return !full_.line(i);
  return false;
}

void result_manager::settle_registers() {
  shown_select_ = selected(domain().next_edge());
  for (unsigned i = 0; i < shown_full_.size(); ++i) shown_full_[i] = full_.line(i);
}

void result_manager::trace(waveform& w) const {
  const std::string n = name();
  w.add(shown_select_, n + ".select", 16);
  for (unsigned i = 0; i < shown_full_.size(); ++i) w.add(shown_full_[i], n + ".full_" + std::to_string(i), 1);
}

void result_manager::params::describe(config::section& s) {
  s.choice("order", leave, order_words(), "as_finished: results leave in the order in which the select finds them");
  s.erratum("valid_withdrawn", valid_withdrawn, "the select turns even while a result is offered and not taken",
            "the offer stays until taken");
}

}  // namespace rtusim
