#include "testbench/bench/surroundings.h"

namespace rtusim {

void source_params::describe(config::section& s) {
  s.choice("valid", valid, regime_words(), "when jobs are offered: at once, with a gap after each, at a fixed pace, or at random");
  s.number("gap_cycles", gap_cycles, {1, 1'000'000}, "cycles", "cycles without an offer after each accepted job")
      .when([this] { return valid == regime::gap; }, "source.valid = gap");
  s.number("interval_cycles", interval_cycles, {1, 1'000'000}, "cycles", "cycles from one job's first offer to the next one's")
      .when([this] { return valid == regime::paced; }, "source.valid = paced");
  s.number("seed", seed, {1, 65'535}, "", "shift register of the random offers in cycle 0")
      .when([this] { return valid == regime::lfsr; }, "source.valid = lfsr");
}

void sink_params::describe(config::section& s) {
  s.choice("ready", ready, regime_words(), "when results are taken: at once, at random, or not at all (to see the watchdog)");
  s.number("seed", seed, {1, 65'535}, "", "shift register of the random readiness in cycle 0")
      .when([this] { return ready == regime::lfsr; }, "sink.ready = lfsr");
}

void surroundings::describe(config::schema& s) {
  s.add("source", source);
  s.add("sink", sink);
  s.add("watchdog", watchdog_);
}

}  // namespace rtusim
