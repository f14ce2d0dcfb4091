#pragma once

#include <cstdint>
#include <vector>

#include "modules/config/report.h"
#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/timing/channel.h"
#include "modules/timing/rotating_select.h"
#include "modules/timing/unit.h"

namespace rtusim {

/// Collects the cores' results in a buffer each and sends them out one by one (Espe 2019, sec. 6.2.5 and app. C.5).
///
/// Timing: an empty buffer takes its core's result at the edge at which that is valid. A select turns by one every clock; the buffer
/// that it points at is offered if it is full, and empty again from the edge after the transfer on. Order `as_finished`.
class result_manager final : public unit {
 public:
  enum class order : std::uint8_t { as_finished };
  static config::word_list order_words() { return {"as_finished"}; }

  struct params {
    order leave = order::as_finished;
    bool valid_withdrawn = false;

    void describe(config::section& s);
  };

  sc_core::sc_vector<rv_in<traversal_result>> core_in;
  rv_out<traversal_result> result_out{"result_out"};

  result_manager(const sc_core::sc_module_name& name, const params& p, unsigned cores);

  const traversal_result& payload_at(cycle c) const;

 private:
  void connect() override;
  void reset() override;
  void edge() override;
  void settle_registers() override;
  bool level(const channel_base& port) const override;
  void trace(waveform& w) const override;
  unsigned selected(cycle c) const;

  bool valid_withdrawn_;  // with one buffer the select has nowhere to turn to
  rotating_select full_;  // the select, and which buffers are full
  std::vector<traversal_result> buffers_;
  cycle offered_from_ = never;  // where an offer stays: since when the buffer under the select is offered
  unsigned shown_select_ = 0;
  std::vector<std::uint8_t> shown_full_;
};

}  // namespace rtusim
