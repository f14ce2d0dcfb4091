#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <systemc>

#include "modules/config/report.h"
#include "modules/timing/calendar.h"
#include "modules/timing/clock_state.h"
#include "modules/timing/unit_figures.h"
#include "modules/timing/unit_timing.h"

namespace rtusim {

class channel_base;
class clock_domain;
class waveform;

/// A registered piece of hardware on one clock. It has no process of its own: its clock domain calls it, and only at the
/// edges at which something happens to it (at every edge in the stepped pace).
///
/// What happens at an edge depends only on registers before it: the unit's own, and which of its ports fire. A unit
/// revises its offers only in `reset` and `edge`; an offer made there holds from the next cycle on.
class unit : public sc_core::sc_module, public booking {
 public:
  /// The cycle of the next edge of this unit: all before it are done.
  cycle next_edge() const { return next_edge_; }
  /// Its contract of timing, once its ports are bound; none where nothing passes through it: at an end, or in a memory that is read within
  /// the cycle.
  virtual std::optional<unit_timing> timing() const { return std::nullopt; }
  /// What it counted in all cycles before the domain's next edge; null if it counts nothing.
  virtual std::unique_ptr<unit_figures> figures() { return nullptr; }

 protected:
  explicit unit(const sc_core::sc_module_name& name);

  /// Says which channels hang together: a junction's, and offers that pass another channel's transfer through.
  virtual void connect() {}
  /// Publishes the offers that hold from cycle 0 on. Called once, at the end of elaboration.
  virtual void reset() = 0;
  /// One clock edge, at `now()`; ports tell whether they fired at it.
  virtual void edge() = 0;
  /// `n` edges at which no port fires and none was booked. Equal to `n` times `edge()`. A unit whose registers move at such edges
  /// says so by `moves_when_idle()` in its constructor; the others are not asked.
  virtual void idle(cycle) {}
  void moves_when_idle() { moves_when_idle_ = true; }
  /// Brings registers that only a watcher sees (see `waveform`) up to date with `next_edge()`.
  virtual void settle_registers() {}
  /// The valid (of an output) or ready (of an input) in cycle `next_edge()` as the settled registers give it, without any
  /// offer: what the pace `checked` holds the offers against.
  virtual bool level(const channel_base& port) const = 0;
  /// Adds the registers and counters to a waveform.
  virtual void trace(waveform& w) const = 0;

  /// The cycle of the edge being done.
  cycle now() const { return clock_->now; }
  /// Asks for `edge()` at cycle c even if no port fires then; a later call replaces an earlier one, `never` takes it back.
  void book_edge(cycle c);
  clock_domain& domain() const { return *domain_; }
  /// Which of the inputs that asked for it (`channel_base::report_arrivals_as`) fired at this edge, in no order.
  const std::vector<unsigned>& arrivals() const { return arrivals_; }

 private:
  friend class clock_domain;
  friend class channel_base;
  friend class waveform;
  clock_domain* domain_ = nullptr;
  const clock_state* clock_ = nullptr;
  cycle next_edge_ = 0;
  bool due_ = false;
  bool moves_when_idle_ = false;
  std::vector<unsigned> arrivals_;
};

}  // namespace rtusim
