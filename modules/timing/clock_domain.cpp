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

void clock_domain::depends(channel_base& offers_of, channel_base& source) { source.dependents_.push_back(&offers_of); }

void clock_domain::start_of_simulation() {
  for (const channel_base* c : channels_)
    if (c->producer_ == nullptr || c->consumer_ == nullptr)
      throw simulation_error(fmt::format("channel {} has no {}", c->name(), c->producer_ == nullptr ? "producer" : "consumer"));
  for (unit* u : units_) u->connect();
  rank_channels();
  for (unit* u : units_) u->reset();
  resolve();
  catch_up();
  alone_ = !has_foreign_process(sc_core::sc_get_top_level_objects());
}

void clock_domain::rank_channels() {
  // A channel ranks after all whose transfers its offers pass through.
  std::vector<channel_base*> ready_to_rank;
  std::vector<std::pair<channel_base*, unsigned>> sources;
  for (channel_base* c : channels_) {
    unsigned count = 0;
    for (const channel_base* other : channels_)
      count += static_cast<unsigned>(std::count(other->dependents_.begin(), other->dependents_.end(), c));
    sources.emplace_back(c, count);
    if (count == 0) ready_to_rank.push_back(c);
  }
  std::size_t ranked = 0;
  unsigned highest = 0;
  for (; ranked < ready_to_rank.size(); ++ranked) {
    channel_base& c = *ready_to_rank[ranked];
    highest = std::max(highest, c.rank_);
    for (channel_base* d : c.dependents_) {
      d->rank_ = std::max(d->rank_, c.rank_ + 1);
      for (auto& [channel, count] : sources)
        if (channel == d && --count == 0) ready_to_rank.push_back(d);
    }
  }
  if (ranked != channels_.size()) throw simulation_error("the offers of the channels depend on each other in a cycle");
  clock_.dirty.resize(highest + 1);
  for (auto& list : clock_.dirty) list.reserve(channels_.size());
  due_.reserve(units_.size());
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
    catch_up();
    waveform_->open(*this);
  }
  next_trigger(period_);
}

void clock_domain::run_edges() {
  for (unsigned n = 0;; ++n) {
    if (tick_ && ++edges_to_tick_ % 100'000 == 0) tick_();
    edge(clock_.next);
    if (stopping_) {
      catch_up();
      if (pace_ == pace::checked) count_checked();
      sc_core::sc_stop();
      return;
    }
    // The next edge of interest: every one while stepping or recording, else the earliest that is booked.
    cycle target = clock_.next;
    if (pace_ == pace::skipping && !recording(clock_.next)) {
      target = std::min(calendar_.earliest(), last_transfer_ + watchdog_ + 1);
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

inline void clock_domain::make_due(unit& u) {
  if (u.due_) return;
  u.due_ = true;
  due_.push(&u);
}

void clock_domain::edge(cycle c) {
  if (c - last_transfer_ > watchdog_) report_deadlock();
  const bool every = pace_ != pace::skipping || recording(c);
  if (every && !current_) catch_up();
  current_ = every;
  if (pace_ == pace::checked) check_levels();
  if (every && watcher_) watcher_(c);
  clock_.now = c;
  clock_.next = c + 1;
  ++stats_.edges;
  if (every) {
    for (unit* u : units_) make_due(*u);
  }
  calendar_.take(c, [&](booking& b) {
    if (b.kind == booking::what::channel) {
      fire(static_cast<channel_base&>(b), c);
    } else {
      make_due(static_cast<unit&>(b));
    }
  });
  call_units(c);
  resolve();
  if (every) {
    for (unit* u : units_) u->settle_registers();
    if (recording(clock_.next) && c + 1 != record_from_ && !stopping_) waveform_->show(*this);
    if (waveform_ != nullptr && clock_.next == record_to_) waveform_->close();
  }
}

void clock_domain::fire(channel_base& ch, cycle c) {
  ch.last_fire_ = c;
  ++ch.transfers_;
  last_transfer_ = c;
  // A junction hands on what its input carries.
  if (ch.upstream_ == nullptr) ch.transferred_ = ch.payload_at(c);
  if (ch.notify_ != nullptr) ch.notify_(ch.observer_, ch.which_, c, ch.transferred_);
  if (ch.arrival_ != channel_base::unlisted) ch.consumer_->arrivals_.push_back(ch.arrival_);
  if (ch.upstream_ == nullptr) make_due(*ch.producer_);
  if (ch.downstream_ == nullptr) {
    make_due(*ch.consumer_);
  } else {
    ch.settle_valid();
    channel_base& output = ch.downstream_->pass(c);
    output.transferred_ = ch.transferred_;
    fire(output, c);
  }
  // Whether a transfer comes again is asked anew even if neither side says more.
  if (ch.upstream_ == nullptr) ch.mark_dirty();
}

void clock_domain::call_units(cycle c) {
  if (shuffle_ != 0) {
    for (std::size_t i = due_.size(); i > 1; --i) {
      shuffle_ = shuffle_ * 1664525u + 1013904223u;
      std::swap(due_[i - 1], due_[shuffle_ % i]);
    }
  }
  for (std::size_t i = 0; i < due_.size(); ++i) {
    unit* const u = due_[i];
    if (u->moves_when_idle_ && u->next_edge_ < c) u->idle(c - u->next_edge_);
    u->edge();
    u->next_edge_ = c + 1;
    u->due_ = false;
    u->arrivals_.clear();
  }
  stats_.unit_edges += due_.size();
  due_.clear();
}

void clock_domain::resolve() {
  const cycle horizon = clock_.next + watchdog_;
  for (auto& rank : clock_.dirty) {
    for (std::size_t i = 0; i < rank.size(); ++i) {
      channel_base& ch = *rank[i];
      ch.dirty_ = false;
      const cycle fires = ch.first_fire(clock_.next, horizon);
      calendar_.book(ch, fires);
      for (channel_base* d : ch.dependents_) d->mark_dirty();
    }
    rank.clear();
  }
}

void clock_domain::catch_up() {
  for (unit* u : units_) {
    if (u->moves_when_idle_ && u->next_edge_ < clock_.next) u->idle(clock_.next - u->next_edge_);
    u->next_edge_ = clock_.next;
    u->settle_registers();
  }
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
  throw simulation_error(fmt::format("no transfer in the {} cycles after cycle {}: {}", watchdog_, last_transfer_,
                                     chain.empty() ? std::string("no channel is valid, so a source gives nothing more") : chain));
}

}  // namespace rtusim
