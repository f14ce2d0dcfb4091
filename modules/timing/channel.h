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

/// A ready/valid channel without its payload: two offers and the first cycle in which both assert. At that edge it hands the payload to
/// the consumer and tells the producer.
class channel_base : public sc_core::sc_object, public virtual sc_core::sc_interface, public booking {
 public:
  enum class side : std::uint8_t { valid, ready };

  /// Whether it transfers at the edge being done, and has not yet.
  bool is_due() const { return at == clock_->now && last_transfer_ != clock_->now; }
  std::uint64_t transfers() const { return transfers_; }

  // They and what they call run several times a ray, and GCC stops inlining them where many units meet in one source.
  /// Replaces the producer's (consumer's) offer from the next cycle on. It ends with the transfer: to go on, offer again.
  [[gnu::always_inline]] void offer_valid(offer o) {
    if (through_ != nullptr && last_transfer_ != clock_->now) remember_valid();
    count_valid();
    valid_ = {std::max(o.from, clock_->next), o.when};
    if (ready_.from != never) solve();
  }
  /// `until`: from here on not, but see `ready_through`.
  [[gnu::always_inline]] void offer_ready(offer o, cycle until = never) {
    count_ready();
    ready_ = {std::max(o.from, clock_->next), o.when};
    ready_until_ = until;
    if (upstream_ != nullptr)
      tell_upstream();
    else if (valid_.from != never)
      solve();
  }
  /// Call before the pattern behind the present valid (ready) offer changes its mind, then offer again.
  void settle_valid() {
    if (valid_.when == nullptr) return;
    count_valid();
    valid_.from = std::max(valid_.from, clock_->next);
  }
  void settle_ready() {
    if (ready_.when == nullptr) return;
    count_ready();
    ready_.from = std::max(ready_.from, clock_->next);
  }
  const offer& valid() const { return valid_; }
  const offer& ready() const { return ready_; }

  /// A consumer with many inputs tells them apart by a number of its own.
  void set_input_index(unsigned i) { input_index_ = i; }
  unsigned input_index() const { return input_index_; }
  /// The consumer is ready, beside its own offer, at the transfers of its output `out` from the end of that offer on, unless the offer ends
  /// before it begins: its stages then move together. It calls `pass` at each of these, which tells whether this channel transferred.
  void ready_through(channel_base& out) { through_ = &out; }
  bool pass();

  /// Division of all cycles before the next edge.
  channel_stats stats() const;

  /// Levels in cycle c as the registers give them, without offers.
  bool valid_level(cycle c) const;
  bool ready_level() const;

  /// Lets `(observer.*Transferred)(which, c, payload)` watch the transfers of payloads that begin with a `Part`. Observers change nothing.
  template <class Part, auto Transferred, class Observer>
  void observe_as(Observer& observer, unsigned which) {
    observer_ = &observer;
    which_ = which;
    notify_ = [](void* o, unsigned w, cycle c, const void* payload) {
      (static_cast<Observer*>(o)->*Transferred)(w, c, *static_cast<const Part*>(payload));
    };
  }

 protected:
  explicit channel_base(const char* name);
  void register_port(sc_core::sc_port_base& port, const char* interface_name) override;

  /// Called at the end of elaboration.
  virtual void bind_ends(unit&, unit&) {}
  /// Tells the consumer and the producer of a transfer.
  virtual void hand_over() {
    consumer_->arrives(*this);
    producer_->leaves(*this);
  }
  /// Copies the payload that is offered in cycle c to where a waveform looks, zeros without an offer.
  virtual void show(cycle c, bool valid) = 0;
  virtual void trace_payload(waveform& w) const = 0;

  const void* payload_at(cycle c) const { return pick_ == nullptr ? payload_ : pick_(picker_, c); }
  void transfer(const void* payload) {
    const cycle c = clock_->now;
    last_transfer_ = clock_->last_transfer = c;
    ++transfers_;
    transferred_ = payload;
    if (notify_ != nullptr) notify_(observer_, which_, c, payload);
    hand_over();
  }

  /// Without an offer of valid of its own.
  void transfer_within(const void* payload) {
    count_ready();
    end(ready_);
    transfer(payload);
  }

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

  /// The transfer of this edge. Both sides offer anew in it; it is solved once, at its end.
  void fire() {
    count_valid();
    count_ready();
    end(valid_);
    end(ready_);
    transfer(payload_at(clock_->now));
    at = never;
    if (valid_.from != never && ready_.from != never) book_transfer();
  }
  [[gnu::always_inline]] void solve() {
    if (at != clock_->now) book_transfer();  // else what was offered before transfers at this edge, and it is solved after that
  }
  void book_transfer();
  cycle first_meeting(cycle from) const;
  /// The offer does, with a transfer, unless it was made at this edge.
  void end(offer& o) {
    if (o.from < clock_->next) o.from = never;
  }
  // Asserted cycles of the present offer, of those before the next edge.
  [[gnu::always_inline]] std::uint64_t present_valid() const {
    if (valid_.from >= clock_->next) return 0;
    return valid_.when == nullptr ? clock_->next - valid_.from : pattern_valid();
  }
  [[gnu::always_inline]] std::uint64_t present_ready() const {
    const cycle stop = std::min(clock_->next, ready_until_);
    if (ready_.from >= stop) return 0;
    return ready_.when == nullptr ? stop - ready_.from : pattern_ready();
  }
  [[gnu::always_inline]] void count_valid() {
    if (downstream_ != nullptr) tell_junction();
    valid_cycles_ += present_valid();
  }
  [[gnu::always_inline]] void count_ready() { ready_cycles_ += present_ready(); }
  std::uint64_t pattern_valid() const;
  std::uint64_t pattern_ready() const;
  void remember_valid();
  void tell_junction();
  void tell_upstream();
  bool is_ready(cycle c) const;
  bool will_fire(cycle c) const;
  void check_levels(cycle c);
  void show_levels(cycle c);

  clock_state* clock_;
  unit* producer_ = nullptr;
  unit* consumer_ = nullptr;
  junction* upstream_ = nullptr;    // the junction that drives valid
  junction* downstream_ = nullptr;  // the junction that consumes
  unsigned output_ = 0;             // which output of `upstream_`
  unsigned input_index_ = 0;

  offer valid_;
  offer ready_;
  cycle ready_until_ = never;
  std::uint64_t valid_cycles_ = 0;  // of offers before
  std::uint64_t ready_cycles_ = 0;
  std::uint64_t transfers_ = 0;
  cycle last_transfer_ = never;
  channel_base* through_ = nullptr;  // see `ready_through`
  cycle revised_ = never;            // the last edge at which valid was, and whether it asserted in that cycle
  bool was_valid_ = false;

  bool shown_valid_ = false;  // levels of the cycle that a waveform shows
  bool shown_ready_ = false;
  std::uint64_t checked_valid_cycles_ = 0;  // counted cycle by cycle while checking
  std::uint64_t checked_ready_cycles_ = 0;
};

/// A channel of a payload, whose type has a `trace_fields(waveform, name, payload)` beside it.
template <class T>
class channel : public channel_base {
 public:
  explicit channel(const char* name) : channel_base(name) {}

  /// The payload of the transfer at this edge, where the producer keeps it: it lies there untouched until the consumer has it.
  const T& data() const { return *static_cast<const T*>(transferred_); }
  /// The payload offered in cycle c, in which valid is asserted.
  const T& offered(cycle c) const { return *static_cast<const T*>(payload_at(c)); }
  /// Where the payload lies until it is transferred.
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
  /// An output of a junction transfers what the input does.
  void carry(const T& payload) { transfer_within(&payload); }
  template <class Observer>
  void observe(Observer& observer, unsigned which) {
    this->template observe_as<T, static_cast<void (Observer::*)(unsigned, cycle, const T&)>(&Observer::transferred)>(observer, which);
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
