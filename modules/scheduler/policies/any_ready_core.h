#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "modules/timing/line_set.h"
#include "modules/timing/offer.h"

namespace rtusim {

/// What policies without a select have in common: a job is taken in the first cycle in which any core is ready, and shown to a core in
/// that cycle alone. Such a policy is an order among the cores that are ready:
///
///     class Order {
///       explicit Order(unsigned cores);
///       /// The first core of which `ready.line(core)` holds; `ready.lines()`, the number of cores, if there is none. `ready.lowest()` is
///       /// the one with the lowest index; `ready.lines()`, too, if there is none.
///       template <class Lines> unsigned first(const Lines& ready) const;
///       void took(unsigned core);  // a job
///     };
template <class Order>
class any_ready_core {
 public:
  explicit any_ready_core(unsigned cores) : ready_(cores), order_(cores), jobs_(cores) {}

  void set_ready(unsigned core, bool ready) { ready_.set_line(core, ready); }
  unsigned selected(cycle) const { return order_.first(ready_); }
  offer ready() const { return ready_.any() ? offer::always_from(0) : offer::none(); }
  template <class Ready>
  bool takes(cycle, const Ready& is_ready) const {
    for (unsigned core = 0; core < ready_.lines(); ++core)
      if (is_ready(core)) return true;
    return false;
  }
  void offered(cycle, cycle) {}
  void take(unsigned core) {
    ready_.set_line(core, false);
    order_.took(core);
    ++jobs_[core];
  }
  std::uint64_t valid_cycles(unsigned core) const { return jobs_[core]; }

  class schedule {
   public:
    explicit schedule(unsigned cores) : order_(cores), jobs_(cores) {}

    template <class Cores>
    cycle dispatch(cycle offered, const Cores& cores) {
      const auto count = static_cast<unsigned>(jobs_.size());
      cycle c = offered;
      for (cores.know(c);; cores.know(++c)) {
        core_ = order_.first(free_cores<Cores>{cores, count, c});
        if (core_ < count) break;
        if constexpr (Cores::known_ahead) c = ready_from(cores) - 1;
      }
      // A job that waited is taken in the first cycle in which any core is ready.
      ready_cycles_ += c > offered ? 1 : c - ready_from(cores) + 1;
      after_last_ = c + 1;
      order_.took(core_);
      ++jobs_[core_];
      return c;
    }
    unsigned core() const { return core_; }
    std::uint64_t valid_cycles(unsigned core) const { return jobs_[core]; }
    template <class Cores>
    std::uint64_t ready_cycles(cycle end, const Cores& cores) const {
      return ready_cycles_ + cycles_from(ready_from(cores), 0, end);
    }

   private:
    /// The cores that are ready in a cycle.
    template <class Cores>
    struct free_cores {
      const Cores& cores;
      unsigned count;
      cycle now;

      unsigned lines() const { return count; }
      bool line(unsigned core) const { return cores.free_from(core) <= now; }
      unsigned lowest() const {
        unsigned core = 0;
        while (core < count && !line(core)) ++core;
        return core;
      }
    };

    /// The first cycle after the last dispatch in which a core is ready.
    template <class Cores>
    cycle ready_from(const Cores& cores) const {
      cycle least = never;
      for (unsigned core = 0; core < jobs_.size(); ++core) {
        least = std::min(least, cores.free_from(core));
        if (least <= after_last_) return after_last_;
      }
      return least;
    }

    Order order_;
    std::vector<std::uint64_t> jobs_;
    unsigned core_ = 0;
    cycle after_last_ = 0;            // the cycle after the last dispatch
    std::uint64_t ready_cycles_ = 0;  // before it
  };

 private:
  line_set ready_;
  Order order_;
  std::vector<std::uint64_t> jobs_;  // that each core took
};

}  // namespace rtusim
