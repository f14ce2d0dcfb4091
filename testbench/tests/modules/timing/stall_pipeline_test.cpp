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
  stall_pipeline<int> p(stages, interval);
  std::vector<std::optional<int>> row(stages);
  cycle since = never;
  int next_item = 0;
  for (cycle c = 0; c < 20'000; ++c) {
    const bool at_output = row[stages - 1].has_value();
    for (unsigned s = 0; s < std::min(stages, 64u); ++s) REQUIRE((p.valid_bits(c) >> s & 1) == row[s].has_value());
    unsigned oldest = stages;
    while (oldest > 0 && !row[oldest - 1]) --oldest;
    REQUIRE(p.empty() == (oldest == 0));
    REQUIRE(at_output == (p.output_from() <= c));
    if (oldest == 0) REQUIRE(p.output_from() == never);
    if (oldest > 0 && !at_output) REQUIRE(p.output_from() == c + stages - oldest);
    if (oldest > 0) REQUIRE(p.output() == *row[oldest - 1]);
    const bool room = since >= interval;
    REQUIRE(room == (p.room_from() <= std::min(c, p.output_from())));
    if (!room && !at_output) REQUIRE(p.room_from() == c + interval - since);

    // Sometimes nothing happens for a while.
    const bool quiet = random() % 8 == 0;
    const bool leaves = at_output && !quiet && random() % 3 != 0;
    const bool moves = leaves || !at_output;
    const bool enters = moves && room && !quiet && random() % 2 != 0;
    if (leaves) p.leave(c);
    if (moves) {
      for (unsigned s = stages - 1; s > 0; --s) row[s] = row[s - 1];
      row[0].reset();
      if (since != never) ++since;
    }
    if (enters) {
      p.enter(c) = next_item;
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
