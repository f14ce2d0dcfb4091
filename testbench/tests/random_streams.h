#pragma once

#include <cstdint>

#include "testbench/bench/simulation.h"
#include "testbench/tests/random.h"

namespace rtusim::test {

/// What surrounds a design of triangle cores, or any other: every regime of the source, and a sink that is ready always or now and then.
inline surroundings random_streams(rng& random) {
  surroundings s;
  s.watchdog_cycles = 100'000;
  s.source.valid = static_cast<source_params::regime>(random() % 4);
  s.source.gap_cycles = 1 + random() % (random() % 8 == 0 ? 2'000 : 40);
  s.source.interval_cycles = 1 + random() % 60;
  s.source.seed = static_cast<std::uint16_t>(1 + random() % 65'535);
  s.sink.ready = static_cast<sink_params::regime>(random() % 2);
  s.sink.seed = static_cast<std::uint16_t>(1 + random() % 65'535);
  return s;
}

}  // namespace rtusim::test
