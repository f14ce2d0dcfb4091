#include "modules/timing/stall_pipeline.h"

#include <catch2/catch.hpp>

#include <optional>
#include "testbench/tests/random.h"

namespace rtusim {

TEST_CASE("stall_pipeline: as a row of registers with one enable", "[timing]") {
  test::rng random(5);
  constexpr unsigned stages = 6;
  stall_pipeline<int, stages> p;
  std::optional<int> row[stages];
  int next_item = 0;
  for (cycle c = 0; c < 50'000; ++c) {
    // Sometimes nothing happens for a while.
    if (random() % 16 == 0) {
      const cycle n = random() % 9;
      p.idle(n);
      for (cycle i = 0; i < n && !row[stages - 1]; ++i) {
        for (unsigned s = stages - 1; s > 0; --s) row[s] = row[s - 1];
        row[0].reset();
      }
      c += n;
    }
    REQUIRE(p.output_valid() == row[stages - 1].has_value());
    for (unsigned s = 0; s < stages; ++s) REQUIRE((p.valid_bits() >> s & 1) == row[s].has_value());
    unsigned oldest = stages;
    while (oldest > 0 && !row[oldest - 1]) --oldest;
    REQUIRE(p.output_from(c) == (oldest == 0 ? never : c + stages - oldest));
    if (oldest > 0) REQUIRE(p.output() == *row[oldest - 1]);

    const bool leaves = p.output_valid() && random() % 3 != 0;
    const bool enable = leaves || !p.output_valid();
    const bool enters = enable && random() % 2 != 0;
    p.edge(leaves, enters ? &next_item : nullptr);
    if (enable) {
      for (unsigned s = stages - 1; s > 0; --s) row[s] = row[s - 1];
      row[0].reset();
      if (enters) row[0] = next_item;
    }
    next_item += enters;
  }
}

}  // namespace rtusim
