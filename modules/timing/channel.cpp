#include "modules/timing/channel.h"

#include "modules/config/error.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/junction.h"

namespace rtusim {

channel_base::channel_base(const char* name) : sc_object(name), booking(what::channel), clock_(&clock_domain::current().join(*this)) {}

void channel_base::register_port(sc_core::sc_port_base& port, const char*) {
  auto* const owner = dynamic_cast<unit*>(port.get_parent_object());
  auto* const end = dynamic_cast<rv_port*>(&port);
  if (owner == nullptr || end == nullptr) return;
  unit*& place = end->drives() == side::valid ? producer_ : consumer_;
  if (place != nullptr)
    throw simulation_error(
        fmt::format("channel {} is bound to two ports of the same side, of {} and {}", name(), place->name(), owner->name()));
  place = owner;
}

void channel_base::tell_upstream() {
  RTU_CHECK(ready_.when == nullptr, ==, true);
  RTU_CHECK(ready_.from == never || ready_.from <= clock_->next, ==, true);
  upstream_->hear(output_, ready_.from != never);
}

void channel_base::tell_junction() {
  RTU_CHECK(valid_.when == nullptr, ==, true);
  if (valid_.from < clock_->next) downstream_->input_valid(valid_.from, clock_->next);
}

void channel_base::remember_valid() {
  if (revised_ == clock_->now) return;
  revised_ = clock_->now;
  was_valid_ = valid_.asserts(revised_);
}

bool channel_base::pass() {
  if (ready_.from > ready_until_) return false;
  count_ready();
  ++ready_cycles_;
  ready_.from = never;
  if (!(revised_ == clock_->now ? was_valid_ : valid_.asserts(clock_->now))) return false;
  at = clock_->now;
  fire();
  return true;
}

void channel_base::book_transfer() {
  cycle first = std::max({clock_->next, valid_.from, ready_.from});
  if (first != never) {
    if (valid_.when != nullptr)
      first = first_meeting(first);
    else if (ready_.when != nullptr)
      first = ready_.when->next(first);
    if (first >= ready_until_) first = never;
  }
  clock_->bookings.book(*this, first);
}

cycle channel_base::first_meeting(cycle from) const {
  const cycle horizon = clock_->next + clock_->watchdog;
  for (cycle v = valid_.next(from); v <= horizon;) {
    const cycle r = ready_.next(v);
    if (r == v) return v;
    if (r > horizon) break;
    v = valid_.next(r);
  }
  return never;
}

// Where the other side asserts all the while, the first cycle of the pattern is that of the transfer.
std::uint64_t channel_base::pattern_valid() const {
  const bool met = ready_.when == nullptr && ready_.from <= valid_.from && ready_until_ == never;
  return met ? is_due() : valid_.when->count(valid_.from, clock_->next);
}

std::uint64_t channel_base::pattern_ready() const {
  const bool met = valid_.when == nullptr && valid_.from <= ready_.from;
  return met ? is_due() : ready_.when->count(ready_.from, std::min(clock_->next, ready_until_));
}

channel_stats channel_base::stats() const {
  const std::uint64_t valid = upstream_ == nullptr ? valid_cycles_ + present_valid() : upstream_->valid_cycles(output_);
  const std::uint64_t ready = ready_cycles_ + present_ready();
  return {transfers_, ready - transfers_, valid - transfers_, clock_->next + transfers_ - valid - ready};
}

bool channel_base::valid_level(cycle c) const {
  if (upstream_ == nullptr) return producer_->level(*this);
  return upstream_->level(*this) && upstream_->points_at(output_, c);
}

bool channel_base::ready_level() const { return consumer_->level(*this); }

bool channel_base::is_ready(cycle c) const {
  if (c < ready_until_) return ready_.asserts(c);
  return through_ != nullptr && ready_.from <= ready_until_ && through_->will_fire(c);
}

bool channel_base::will_fire(cycle c) const { return at == c || (through_ != nullptr && valid_.asserts(c) && is_ready(c)); }

void channel_base::check_levels(cycle c) {
  const bool v = valid_level(c);
  const bool r = ready_level();
  if (upstream_ == nullptr) {
    if (v != valid_.asserts(c) || r != is_ready(c) || (v && r) != will_fire(c))
      throw simulation_error(fmt::format("{}: offers and registers differ in cycle {}: valid {} against {}, ready {} against {}, fires {}",
                                         name(), c, valid_.asserts(c), v, is_ready(c), r, will_fire(c)));
  } else if (r != is_ready(c)) {
    throw simulation_error(fmt::format("{}: offered ready {} differs from the registers' in cycle {}", name(), is_ready(c), c));
  }
  checked_valid_cycles_ += v;
  checked_ready_cycles_ += r;
}

void channel_base::show_levels(cycle c) {
  shown_valid_ = valid_level(c);
  shown_ready_ = ready_level();
  show(c, shown_valid_);
}

void channel_stats::describe(config::report& r) const {
  r.number("transferred", transferred, "cycles", "cycles with a transfer: valid and ready");
  r.number("starved", starved, "cycles", "cycles in which the consumer waits: ready, not valid");
  r.number("back_pressured", back_pressured, "cycles", "cycles in which the producer waits: valid, not ready");
  r.number("idle", idle, "cycles", "cycles in which neither side asserts");
}

}  // namespace rtusim
