#pragma once

#include <cstdint>
#include <string_view>

#include "modules/numeric/divisor.h"
#include "modules/scheduler/policies/turn_counts.h"
#include "modules/timing/offer.h"
#include "modules/timing/rotating_select.h"

namespace rtusim {

/// A select turns by one every cycle; a job goes where it points if that core is ready (Espe 2019, sec. 6.2.2 and app. C.3). With one
/// core it has nowhere to turn to.
class cyclic_first_available {
 public:
  static constexpr std::string_view name = "cyclic_first_available";
  static constexpr std::string_view meaning = "a select that turns every cycle";

  explicit cyclic_first_available(unsigned cores) : ready_(cores), shown_(cores) {}

  void set_ready(unsigned core, bool ready) { ready_.set_line(core, ready); }
  unsigned selected(cycle c) const { return turns() ? ready_.selected(c) : 0; }
  offer ready() const {
    if (turns()) return offer::in(ready_);
    return ready_.any() ? offer::always_from(0) : offer::none();
  }
  template <class Ready>
  bool takes(cycle c, const Ready& is_ready) const {
    return is_ready(selected(c));
  }
  void offered(cycle from, cycle to) { shown_.add(selected(from), to - from); }
  void take(unsigned core) { ready_.set_line(core, false); }
  std::uint64_t valid_cycles(unsigned core) const { return shown_.cycles(core); }

  class schedule {
   public:
    explicit schedule(unsigned cores) : cores_(cores), by_cores_(cores), shown_(cores) {}

    template <class Cores>
    cycle dispatch(cycle offered, const Cores& cores) {
      const std::uint64_t turned = core_ + (offered - cycle_);
      const unsigned first = turned < cores_ ? static_cast<unsigned>(turned) : by_cores_.remainder(turned);
      cycle c = offered;
      unsigned at = first;
      for (;; ++c, at = at + 1 < cores_ ? at + 1 : 0) {
        cores.know(c);
        if (cores.free_from(at) <= c) break;
      }
      shown_.add(first, c - offered + 1);
      ready_cycles_ += by_cores_.quotient(c - cores.free_from(at)) + 1;
      core_ = at;
      cycle_ = c;
      return c;
    }
    unsigned core() const { return core_; }
    std::uint64_t valid_cycles(unsigned core) const { return shown_.cycles(core); }
    template <class Cores>
    std::uint64_t ready_cycles(cycle end, const Cores& cores) const {
      std::uint64_t sum = ready_cycles_;
      for (unsigned i = 0; i < cores_; ++i) {
        const cycle from = cores.free_from(i);
        const unsigned now = by_cores_.remainder(from);
        const cycle turn = from + (i >= now ? i - now : i + cores_ - now);
        if (turn < end) sum += by_cores_.quotient(end - 1 - turn) + 1;
      }
      return sum;
    }

   private:
    unsigned cores_;
    divisor by_cores_;
    turn_counts shown_;
    unsigned core_ = 0;  // the select in `cycle_`
    cycle cycle_ = 0;
    std::uint64_t ready_cycles_ = 0;  // of the cores until they took their last jobs, each under the select
  };

 private:
  bool turns() const { return ready_.lines() > 1; }

  rotating_select ready_;  // which cores are ready, under the select register
  turn_counts shown_;
};

}  // namespace rtusim
