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
  upstream_->output_ready(output_, ready_.from != never);
}

void channel_base::tell_junction(cycle end) {
  RTU_CHECK(valid_.when == nullptr, ==, true);
  const cycle begin = std::max(valid_since_, valid_.from);
  if (begin < end) downstream_->input_valid(begin, end);
}

cycle channel_base::first_meeting(cycle from, cycle horizon) const {
  for (cycle v = valid_.next(from); v <= horizon;) {
    const cycle r = ready_.next(v);
    if (r == v) return v;
    if (r > horizon) break;
    v = valid_.next(r);
    if (v == r) return v;
  }
  return never;
}

channel_stats channel_base::stats() {
  settle_ready();
  if (upstream_ == nullptr)
    settle_valid();
  else
    valid_cycles_ = upstream_->valid_cycles(output_);
  const std::uint64_t all = clock_->next;
  return {transfers_, ready_cycles_ - transfers_, valid_cycles_ - transfers_, all + transfers_ - valid_cycles_ - ready_cycles_};
}

bool channel_base::valid_level(cycle c) const {
  if (upstream_ == nullptr) return producer_->level(*this);
  return upstream_->level(*this) && upstream_->points_at(output_, c);
}

bool channel_base::ready_level() const { return consumer_->level(*this); }

void channel_base::check_levels(cycle c) {
  const bool v = valid_level(c);
  const bool r = ready_level();
  if (upstream_ == nullptr) {
    if (v != valid_.asserts(c) || r != ready_.asserts(c) || (v && r) != (at == c))
      throw simulation_error(fmt::format("{}: offers and registers differ in cycle {}: valid {} against {}, ready {} against {}, fires {}",
                                         name(), c, valid_.asserts(c), v, ready_.asserts(c), r, at == c));
  } else if (r != ready_.asserts(c)) {
    throw simulation_error(fmt::format("{}: offered ready {} differs from the registers' in cycle {}", name(), ready_.asserts(c), c));
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
