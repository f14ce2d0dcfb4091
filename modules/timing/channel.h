#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <systemc>

#include "modules/config/report.h"
#include "modules/timing/calendar.h"
#include "modules/timing/clock_state.h"
#include "modules/timing/offer.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"

namespace rtusim {

class clock_domain;
class junction;
class waveform;

/// How the cycles of a channel divide, told from valid and ready alone.
struct channel_stats {
  std::uint64_t transferred = 0;     ///< valid and ready
  std::uint64_t starved = 0;         ///< ready, not valid
  std::uint64_t back_pressured = 0;  ///< valid, not ready
  std::uint64_t idle = 0;            ///< neither

  void describe(config::report& r) const;
};

/// A ready/valid channel without its payload: two offers and the first cycle in which both assert.
class channel_base : public sc_core::sc_object, public virtual sc_core::sc_interface, public booking {
 public:
  enum class side : std::uint8_t { valid, ready };

  /// Whether it transfers at the edge being done.
  bool fired() const { return last_fire_ == clock_->now && last_fire_ != never; }
  /// The cycle of the next transfer if nothing else fires before, or never.
  cycle fires_at() const { return at; }
  cycle last_fire() const { return last_fire_; }
  std::uint64_t transfers() const { return transfers_; }

  // They and what they call run several times a ray, and GCC stops inlining them where many units meet in one source.
  /// Replaces the producer's (consumer's) offer from the next cycle on.
  [[gnu::always_inline]] void offer_valid(offer o) {
    settle_valid();
    valid_ = o;
    mark_dirty();
  }
  [[gnu::always_inline]] void offer_ready(offer o) {
    settle_ready();
    ready_ = o;
    if (upstream_ == nullptr)
      mark_dirty();
    else
      tell_upstream();
  }
  /// Call before the pattern behind the present ready (valid) offer changes its mind, then offer again.
  [[gnu::always_inline]] void settle_valid() {
    const cycle end = clock_->next;
    if (end == valid_since_) return;
    if (downstream_ != nullptr) tell_junction(end);
    // Where the other side asserts all the while, each asserted cycle was a transfer.
    const bool met = valid_.when != nullptr && ready_.when == nullptr && std::max(ready_.from, ready_since_) <= valid_since_;
    valid_cycles_ += met ? transfers_ - valid_settled_ : valid_.count(valid_since_, end);
    valid_settled_ = transfers_;
    valid_since_ = end;
  }
  [[gnu::always_inline]] void settle_ready() {
    const cycle end = clock_->next;
    if (end == ready_since_) return;
    const bool met = ready_.when != nullptr && valid_.when == nullptr && std::max(valid_.from, valid_since_) <= ready_since_;
    ready_cycles_ += met ? transfers_ - ready_settled_ : ready_.count(ready_since_, end);
    ready_settled_ = transfers_;
    ready_since_ = end;
  }
  /// A consumer with many inputs lists the transfers of this one as `which` in its `arrivals`.
  void report_arrivals_as(unsigned which) { arrival_ = which; }
  const offer& valid() const { return valid_; }
  const offer& ready() const { return ready_; }

  /// Division of all cycles before the next edge.
  channel_stats stats();

  /// Levels in cycle c as the registers give them, without offers.
  bool valid_level(cycle c) const;
  bool ready_level() const;

  /// Lets `observer.transferred(which, c, payload)` watch the transfers of payloads that begin with a `Part`. Observers change nothing.
  template <class Part, class Observer>
  void observe_as(Observer& observer, unsigned which) {
    observer_ = &observer;
    which_ = which;
    notify_ = [](void* o, unsigned w, cycle c, const void* payload) {
      static_cast<Observer*>(o)->transferred(w, c, *static_cast<const Part*>(payload));
    };
  }

 protected:
  explicit channel_base(const char* name);
  void register_port(sc_core::sc_port_base& port, const char* interface_name) override;

  /// Copies the payload that is offered in cycle c to where a waveform looks, zeros without an offer.
  virtual void show(cycle c, bool valid) = 0;
  virtual void trace_payload(waveform& w) const = 0;

  const void* payload_at(cycle c) const { return pick_ == nullptr ? payload_ : pick_(picker_, c); }

  const void* payload_ = nullptr;  // what is offered, where that does not depend on the cycle
  const void* (*pick_)(const void* picker, cycle c) = nullptr;
  const void* picker_ = nullptr;
  const void* transferred_ = nullptr;  // at the edge being done
  void (*notify_)(void* observer, unsigned which, cycle c, const void* payload) = nullptr;
  void* observer_ = nullptr;
  unsigned which_ = 0;

 private:
  friend class clock_domain;
  friend class junction;
  friend class waveform;

  static constexpr unsigned unlisted = ~0u;

  [[gnu::always_inline]] void mark_dirty() {
    if (dirty_) return;
    dirty_ = true;
    clock_->dirty[rank_].push(this);
  }
  void tell_junction(cycle end);
  void tell_upstream();
  cycle first_fire(cycle from, cycle horizon) const {
    if (valid_.from == never || ready_.from == never) return never;
    if (valid_.when == nullptr && ready_.when == nullptr) return std::max({from, valid_.from, ready_.from});
    return first_meeting(from, horizon);
  }
  cycle first_meeting(cycle from, cycle horizon) const;
  void check_levels(cycle c);
  void show_levels(cycle c);

  clock_state* clock_;
  unit* producer_ = nullptr;
  unit* consumer_ = nullptr;
  junction* upstream_ = nullptr;    // the junction that drives valid
  junction* downstream_ = nullptr;  // the junction that consumes
  unsigned output_ = 0;             // which output of `upstream_`
  unsigned arrival_ = unlisted;

  offer valid_;
  offer ready_;
  cycle valid_since_ = 0;  // cycles before are in valid_cycles_
  cycle ready_since_ = 0;
  std::uint64_t valid_cycles_ = 0;
  std::uint64_t ready_cycles_ = 0;
  std::uint64_t transfers_ = 0;
  std::uint64_t valid_settled_ = 0;  // of them, when the valid (ready) cycles were counted last
  std::uint64_t ready_settled_ = 0;
  cycle last_fire_ = never;
  bool dirty_ = false;
  unsigned rank_ = 0;
  std::vector<channel_base*> dependents_;  // whose offers pass this channel's transfer through

  std::uint64_t checked_valid_cycles_ = 0;  // counted cycle by cycle while checking
  std::uint64_t checked_ready_cycles_ = 0;
  bool shown_valid_ = false;  // levels of the cycle that a waveform shows
  bool shown_ready_ = false;
};

/// A channel of a payload, whose type has a `trace_fields(waveform, name, payload)` beside it.
template <class T>
class channel final : public channel_base {
 public:
  explicit channel(const char* name) : channel_base(name) {}

  /// The payload of the transfer at this edge, where the producer keeps it: it lies there untouched until the edge is done.
  const T& data() const { return *static_cast<const T*>(transferred_); }
  /// The payload offered in cycle c, in which valid is asserted.
  const T& offered(cycle c) const { return *static_cast<const T*>(payload_at(c)); }
  /// Where the payload lies until the edge of its transfer is done.
  void drive(const T& payload) { payload_ = &payload; }
  /// The payload depends on the cycle: it is `owner.payload_at(c)`.
  template <class Owner>
  void drive_from(const Owner& owner) {
    picker_ = &owner;
    pick_ = [](const void* o, cycle c) -> const void* {
      const T& payload = static_cast<const Owner*>(o)->payload_at(c);
      return &payload;
    };
  }
  template <class Observer>
  void observe(Observer& observer, unsigned which) {
    observe_as<T>(observer, which);
  }

 private:
  void show(cycle c, bool valid) override { shown_ = valid ? offered(c) : T{}; }
  void trace_payload(waveform& w) const override { trace_fields(w, std::string(name()), shown_); }

  T shown_{};
};

/// Ports of either side. A unit binds to the channel, not to the unit behind it.
class rv_port {
 public:
  explicit rv_port(channel_base::side s) : side_(s) {}
  virtual ~rv_port() = default;
  channel_base::side drives() const { return side_; }

 private:
  channel_base::side side_;
};

template <class T>
class rv_in : public sc_core::sc_port<channel<T>>, public rv_port {
 public:
  explicit rv_in(const char* name) : sc_core::sc_port<channel<T>>(name), rv_port(channel_base::side::ready) {}
};

template <class T>
class rv_out : public sc_core::sc_port<channel<T>>, public rv_port {
 public:
  explicit rv_out(const char* name) : sc_core::sc_port<channel<T>>(name), rv_port(channel_base::side::valid) {}
};

/// A consumer of any payload, which it does not look at.
class rv_in_any : public sc_core::sc_port<channel_base>, public rv_port {
 public:
  explicit rv_in_any(const char* name) : sc_core::sc_port<channel_base>(name), rv_port(channel_base::side::ready) {}
};

}  // namespace rtusim
