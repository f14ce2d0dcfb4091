#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "modules/timing/line_set.h"
#include "modules/timing/offer.h"

namespace rtusim {

/// The select points at the next core in line and moves on when that takes a job.
class round_robin {
 public:
  static constexpr std::string_view name = "round_robin";
  static constexpr std::string_view meaning = "the next core in line";

  explicit round_robin(unsigned cores) : ready_(cores), valid_cycles_(cores) {}

  void set_ready(unsigned core, bool ready) { ready_.set_line(core, ready); }
  unsigned selected(cycle) const { return in_line_; }
  offer ready() const { return ready_.line(in_line_) ? offer::always_from(0) : offer::none(); }
  template <class Ready>
  bool takes(cycle, const Ready& is_ready) const {
    return is_ready(in_line_);
  }
  void offered(cycle from, cycle to) { valid_cycles_[in_line_] += to - from; }
  void take(unsigned core) {
    ready_.set_line(core, false);
    in_line_ = core + 1 < ready_.lines() ? core + 1 : 0;
  }
  std::uint64_t valid_cycles(unsigned core) const { return valid_cycles_[core]; }

  class schedule {
   public:
    explicit schedule(unsigned cores) : valid_cycles_(cores) {}

    template <class Cores>
    cycle dispatch(cycle offered, const Cores& cores) {
      core_ = in_line_;
      in_line_ = in_line_ + 1 < valid_cycles_.size() ? in_line_ + 1 : 0;
      cycle c = offered;
      if constexpr (!Cores::known_ahead)
        for (cores.know(c); cores.free_from(core_) > c; cores.know(c)) ++c;
      const cycle free_from = cores.free_from(core_);
      c = std::max(c, free_from);
      valid_cycles_[core_] += c - offered + 1;
      ready_cycles_ += c - std::max(pointed_from_, free_from) + 1;
      pointed_from_ = c + 1;
      return c;
    }
    unsigned core() const { return core_; }
    std::uint64_t valid_cycles(unsigned core) const { return valid_cycles_[core]; }
    template <class Cores>
    std::uint64_t ready_cycles(cycle end, const Cores& cores) const {
      return ready_cycles_ + cycles_from(cores.free_from(in_line_), pointed_from_, end);
    }

   private:
    std::vector<std::uint64_t> valid_cycles_;
    unsigned core_ = 0;
    unsigned in_line_ = 0;
    cycle pointed_from_ = 0;          // since when the select points there
    std::uint64_t ready_cycles_ = 0;  // before
  };

 private:
  line_set ready_;
  unsigned in_line_ = 0;  // the select register
  std::vector<std::uint64_t> valid_cycles_;
};

}  // namespace rtusim
