#pragma once

#include <memory>
#include <optional>

#include <systemc>

#include "modules/config/unit_figures.h"
#include "modules/timing/calendar.h"
#include "modules/timing/clock_state.h"
#include "modules/timing/unit_timing.h"

namespace rtusim {

class channel_base;
class clock_domain;
class waveform;

/// A registered piece of hardware on one clock. It has no process of its own: channels call it as they transfer, and its clock domain at
/// the edges that it booked.
///
/// What happens at an edge depends only on registers before it. The calls of one edge come in any order, and what a unit does in one of
/// them must be right whether the others of this edge came before or come after: those of its transfers, in any order, then that of a
/// booked edge. It revises its offers only in these calls and in `reset`; an offer made there holds from the next cycle on.
class unit : public sc_core::sc_module, public booking {
 public:
  /// The payload of `in` has come in at the edge `now()`: `data()` of the channel until the call ends.
  virtual void arrives(channel_base&) {}
  /// The payload of `out` has gone at the edge `now()`.
  virtual void leaves(channel_base&) {}
  /// The edge that was asked for by `book_edge`, after the edge's transfers.
  virtual void booked_edge() {}

  /// The cycle of the next edge: all before it are done.
  cycle next_edge() const { return clock_->next; }
  /// Its contract of timing, once its ports are bound; none where nothing passes through it: at an end, or in a memory that is read within
  /// the cycle.
  virtual std::optional<unit_timing> timing() const { return std::nullopt; }
  /// What it counted in all cycles before the next edge; null if it counts nothing.
  virtual std::unique_ptr<unit_figures> figures() { return nullptr; }

 protected:
  explicit unit(const sc_core::sc_module_name& name);

  /// Says what its channels must know of it: a junction's, and an input that an output's transfers pass through.
  virtual void connect() {}
  /// Publishes the offers that hold from cycle 0 on. Called once, at the end of elaboration.
  virtual void reset() = 0;
  /// Brings registers that only a watcher sees up to date with `next_edge()`. Called at every edge in the paces that step.
  virtual void settle_registers() {}
  /// The valid (of an output) or ready (of an input) in cycle `next_edge()` as the settled registers give it, without any
  /// offer: what the pace `checked` holds the offers against.
  virtual bool level(const channel_base& port) const = 0;
  /// Adds the registers and counters to a waveform.
  virtual void trace(waveform& w) const = 0;

  /// The cycle of the edge being done.
  cycle now() const { return clock_->now; }
  /// Asks for `booked_edge()` at cycle c; a later call replaces an earlier one, `never` takes it back.
  void book_edge(cycle c) { clock_->bookings.book(*this, c); }
  clock_domain& domain() const { return *domain_; }

 private:
  friend class clock_domain;
  friend class channel_base;
  friend class waveform;
  clock_domain* domain_ = nullptr;
  clock_state* clock_ = nullptr;
};

}  // namespace rtusim
