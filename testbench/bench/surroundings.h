#pragma once

#include <cstdint>

#include "modules/config/schema.h"
#include "modules/config/section.h"

namespace rtusim {

/// When a source offers what it has.
struct source_params {
  enum class regime : std::uint8_t { always, gap, paced, lfsr };
  static config::word_list regime_words() { return {"always", "gap", "paced", "lfsr"}; }

  regime valid = regime::always;
  unsigned gap_cycles = 1;
  unsigned interval_cycles = 4;
  std::uint16_t seed = 0xBEEF;

  void describe(config::section& s);
};

/// When a sink takes what comes.
struct sink_params {
  enum class regime : std::uint8_t { always, lfsr, blocked };
  static config::word_list regime_words() { return {"always", "lfsr", "never"}; }

  regime ready = regime::always;
  std::uint16_t seed = 0xACE1;

  void describe(config::section& s);
};

/// What surrounds the design in a run, outside its identity.
struct surroundings {
  source_params source;
  sink_params sink;
  std::uint64_t watchdog_cycles = 1'000'000;

  /// Its sections may stand in any file.
  void describe(config::schema& s);

 private:
  struct watchdog_params {
    std::uint64_t* cycles;
    void describe(config::section& s) {
      s.number("cycles", *cycles, {1'000, 1'000'000'000}, "cycles", "a run without a transfer for so long ends");
    }
  } watchdog_{&watchdog_cycles};
};

}  // namespace rtusim
