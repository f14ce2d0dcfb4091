#include "modules/timing/clock_domain.h"

#include <algorithm>
#include <limits>
#include <string>

#include "modules/config/error.h"
#include "modules/timing/channel.h"
#include "modules/timing/junction.h"
#include "modules/timing/unit.h"
#include "modules/timing/waveform.h"

namespace rtusim {
namespace {

clock_domain* current_domain = nullptr;

/// So many edges at most in one wake-up, so that SystemC's time follows.
constexpr unsigned edges_a_wake_up = 1u << 16;

/// Whether there is a process that is no clock domain's.
bool has_foreign_process(const std::vector<sc_core::sc_object*>& objects) {
  return std::any_of(objects.begin(), objects.end(), [](sc_core::sc_object* o) {
    const sc_core::sc_object* const owner = o->get_parent_object();
    const bool ours = dynamic_cast<const clock_domain*>(owner) != nullptr;
    return (dynamic_cast<sc_core::sc_process_b*>(o) != nullptr && !ours) || has_foreign_process(o->get_child_objects());
  });
}

}  // namespace

clock_domain::clock_domain(const sc_core::sc_module_name& name, double clock_mhz)
    : sc_module(name), period_(1.0 / clock_mhz, sc_core::SC_US) {
  current_domain = this;
  SC_HAS_PROCESS(clock_domain);
  SC_METHOD(wake_up);
}

clock_domain::~clock_domain() {
  if (current_domain == this) current_domain = nullptr;
}

clock_domain& clock_domain::current() {
  if (current_domain == nullptr) throw simulation_error("a unit or channel was constructed before its clock domain");
  return *current_domain;
}

void clock_domain::add(unit& u) {
  u.domain_ = this;
  u.clock_ = &clock_;
  units_.push_back(&u);
}

clock_state& clock_domain::join(channel_base& c) {
  channels_.push_back(&c);
  return clock_;
}

void clock_domain::start_of_simulation() {
  for (const channel_base* c : channels_)
    if (c->producer_ == nullptr || c->consumer_ == nullptr)
      throw simulation_error(fmt::format("channel {} has no {}", c->name(), c->producer_ == nullptr ? "producer" : "consumer"));
  for (channel_base* c : channels_) c->bind_ends(*c->producer_, *c->consumer_);
  for (unit* u : units_) u->connect();
  for (unit* u : units_) u->reset();
  alone_ = !has_foreign_process(sc_core::sc_get_top_level_objects());
}

clock_stats clock_domain::stats() const {
  clock_stats s = stats_;
  for (const channel_base* ch : channels_) s.unit_edges += 2 * ch->transfers_;
  return s;
}

void clock_domain::record(waveform& w, cycle from, cycle to) {
  waveform_ = &w;
  record_from_ = from;
  record_to_ = to;
}

void clock_domain::start_recording() { record_from_ = clock_.next; }

void clock_domain::stop_recording() { record_to_ = clock_.next; }

void clock_domain::start() {
  sc_core::sc_start();
  if (error_) std::rethrow_exception(error_);
}

void clock_domain::wake_up() {
  try {
    ++stats_.wake_ups;
    if (sc_core::sc_time_stamp() == begin_of(clock_.next))
      begin_cycle();
    else
      run_edges();
  } catch (...) {
    error_ = std::current_exception();
    sc_core::sc_stop();
  }
}

sc_core::sc_time clock_domain::begin_of(cycle c) const { return period_ * static_cast<double>(c); }

void clock_domain::begin_cycle() {
  if (recording(clock_.next)) {
    settle_units();
    waveform_->open(*this);
  }
  next_trigger(period_);
}

void clock_domain::run_edges() {
  for (unsigned n = 0;; ++n) {
    if (++edges_to_tick_ % 100'000 == 0 && tick_) tick_();
    edge(clock_.next);
    if (stopping_) {
      if (pace_ == pace::checked) count_checked();
      sc_core::sc_stop();
      return;
    }
    // The next edge of interest: every one while stepping or recording, else the earliest that is booked.
    cycle target = clock_.next;
    if (pace_ == pace::skipping && !recording(target)) {
      target = std::min(clock_.bookings.earliest(), clock_.last_transfer + clock_.watchdog + 1);
      if (waveform_ != nullptr && clock_.next < record_from_) target = std::min(target, record_from_);
    }
    clock_.next = target;
    if (recording(target) || n == edges_a_wake_up || (!alone_ && sc_core::sc_pending_activity())) {
      const bool begins = waveform_ != nullptr && target == record_from_;
      next_trigger(begin_of(begins ? target : target + 1) - sc_core::sc_time_stamp());
      return;
    }
  }
}

void clock_domain::edge(cycle c) {
  if (c - clock_.last_transfer > clock_.watchdog) report_deadlock();
  const bool every = pace_ != pace::skipping || recording(c);
  if (every && !settled_) settle_units();
  settled_ = every;
  if (pace_ == pace::checked) check_levels();
  if (every && watcher_) watcher_(c);
  clock_.now = c;
  clock_.next = c + 1;
  ++stats_.edges;
  clock_.bookings.take(c, [this](booking& b) {
    if (b.kind == booking::what::channel && shuffle_ == 0) {
      static_cast<channel_base&>(b).fire();
    } else {
      if (b.kind == booking::what::unit) b.at = never;
      due_.push_back(&b);
    }
  });
  if (!due_.empty()) call_due();
  if (every) {
    settle_units();
    if (recording(clock_.next) && c + 1 != record_from_ && !stopping_) waveform_->show(*this);
    if (waveform_ != nullptr && clock_.next == record_to_) waveform_->close();
  }
}

void clock_domain::call_due() {
  if (shuffle_ != 0) {
    for (std::size_t i = due_.size(); i > 1; --i) {
      shuffle_ = shuffle_ * 1664525u + 1013904223u;
      std::swap(due_[i - 1], due_[shuffle_ % i]);
    }
  }
  for (booking* const b : due_)
    if (b->kind == booking::what::channel) static_cast<channel_base*>(b)->fire();
  for (booking* const b : due_) {
    if (b->kind != booking::what::unit) continue;
    static_cast<unit*>(b)->booked_edge();
    ++stats_.unit_edges;
  }
  due_.clear();
}

void clock_domain::settle_units() {
  for (unit* u : units_) u->settle_registers();
}

void clock_domain::check_levels() {
  for (channel_base* ch : channels_) ch->check_levels(clock_.next);
  ++checked_;
}

void clock_domain::count_checked() {
  if (checked_ != clock_.next) return;  // not from the beginning
  for (channel_base* ch : channels_) {
    const channel_stats s = ch->stats();
    RTU_CHECK(s.transferred + s.back_pressured, ==, ch->checked_valid_cycles_);
    RTU_CHECK(s.transferred + s.starved, ==, ch->checked_ready_cycles_);
  }
}

void clock_domain::report_deadlock() const {
  std::string chain;
  for (const channel_base* ch : channels_) {
    const bool v = ch->upstream_ == nullptr ? ch->valid_.asserts(clock_.next) : false;
    if (!v) continue;
    chain +=
        fmt::format("{}{}: {} waits for {}", chain.empty() ? "" : "; ", ch->name(), ch->producer_->basename(), ch->consumer_->basename());
  }
  throw simulation_error(fmt::format("no transfer in the {} cycles after cycle {}: {}", clock_.watchdog, clock_.last_transfer,
                                     chain.empty() ? std::string("no channel is valid, so a source gives nothing more") : chain));
}

}  // namespace rtusim
