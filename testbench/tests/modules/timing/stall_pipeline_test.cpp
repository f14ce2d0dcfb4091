#include "modules/timing/stall_pipeline.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <optional>
#include <vector>

#include "testbench/tests/random.h"

namespace rtusim {
namespace {

/// Against registers in a row with one enable, which nothing enters within `interval` moves of the last time.
void compare_with_registers(unsigned stages, unsigned interval, unsigned seed) {
  test::rng random(seed);
  stall_pipeline<int> p(stages);
  std::vector<std::optional<int>> row(stages);
  cycle since = never;
  const auto shift = [&] {
    for (unsigned s = stages - 1; s > 0; --s) row[s] = row[s - 1];
    row[0].reset();
    if (since != never) ++since;
  };
  int next_item = 0;
  for (cycle c = 0; c < 20'000; ++c) {
    // Sometimes nothing happens for a while.
    if (random() % 16 == 0) {
      const cycle n = random() % 9;
      p.idle(n);
      for (cycle i = 0; i < n && !row[stages - 1]; ++i) shift();
      c += n;
    }
    REQUIRE(p.output_valid() == row[stages - 1].has_value());
    for (unsigned s = 0; s < std::min(stages, 64u); ++s) REQUIRE((p.valid_bits() >> s & 1) == row[s].has_value());
    unsigned oldest = stages;
    while (oldest > 0 && !row[oldest - 1]) --oldest;
    REQUIRE(p.empty() == (oldest == 0));
    REQUIRE(p.output_from(c) == (oldest == 0 ? never : c + stages - oldest));
    if (oldest > 0) REQUIRE(p.output() == *row[oldest - 1]);
    REQUIRE(p.since_entry() == since);

    const bool leaves = p.output_valid() && random() % 3 != 0;
    const bool moves = leaves || !p.output_valid();
    const bool enters = moves && since >= interval && random() % 2 != 0;
    REQUIRE(p.advance(leaves) == moves);
    if (moves) shift();
    if (enters) {
      p.enter() = next_item;
      row[0] = next_item++;
      since = 1;
    }
  }
}

}  // namespace

TEST_CASE("stall_pipeline: as a row of registers with one enable", "[timing]") {
  compare_with_registers(6, 1, 5);
  compare_with_registers(1, 1, 6);
  compare_with_registers(64, 1, 7);
  compare_with_registers(33, 33, 8);
  compare_with_registers(20, 7, 9);
  compare_with_registers(72, 1, 10);
  compare_with_registers(140, 7, 11);
}

}  // namespace rtusim
