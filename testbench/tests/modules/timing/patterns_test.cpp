#include <catch2/catch.hpp>

#include <functional>
#include "testbench/tests/random.h"

#include "modules/timing/rotating_select.h"
#include "testbench/bench/lfsr.h"

namespace rtusim {
namespace {

/// `next` and `count` against the level, cycle by cycle.
void check_pattern(const pattern& p, const std::function<bool(cycle)>& level, cycle from, cycle to) {
  std::uint64_t ones = 0;
  for (cycle c = from; c < to; ++c) {
    REQUIRE(p.count(from, c) == ones);
    if (level(c)) {
      REQUIRE(p.next(c) == c);
      ++ones;
    } else {
      const cycle n = p.next(c);
      REQUIRE(n > c);
      if (n < to) REQUIRE(level(n));
      for (cycle d = c; d < std::min(n, to); ++d) REQUIRE_FALSE(level(d));
    }
  }
}

}  // namespace

TEST_CASE("rotating_select: the signal under the select", "[timing]") {
  test::rng random(3);
  for (const unsigned lines : {1u, 2u, 3u, 5u, 16u, 63u, 64u, 65u, 130u}) {
    rotating_select s(lines);
    CHECK(s.next(0) == never);
    for (int round = 0; round < 6; ++round) {
      for (unsigned i = 0; i < lines; ++i) s.set_line(i, random() % 8 < static_cast<unsigned>(round));
      s.select(random() % lines, random() % 1000);
      if (!s.any()) continue;
      const cycle from = random() % 500;
      check_pattern(
          s, [&](cycle c) { return s.line(s.selected(c)); }, from, from + 3 * lines + 5);
      for (unsigned i = 0; i < s.lowest(); ++i) CHECK_FALSE(s.line(i));
      CHECK(s.line(s.lowest()));
    }
    s.select(lines - 1, 77);
    CHECK(s.selected(77) == lines - 1);
    CHECK(s.selected(78) == 0);
  }
}

TEST_CASE("lfsr: bit 0 of the register, over its period", "[timing]") {
  for (const std::uint16_t seed : {std::uint16_t{0xACE1}, std::uint16_t{0xBEEF}, std::uint16_t{1}}) {
    const lfsr l(seed);
    std::uint16_t x = seed;
    for (cycle c = 0; c < lfsr::period + 10; ++c, x = lfsr::step(x)) REQUIRE(l.state(c) == x);
    check_pattern(
        l, [&](cycle c) { return (l.state(c) & 1) != 0; }, lfsr::period - 40, lfsr::period + 200);
    CHECK(l.count(0, lfsr::period) == 32768);
  }
}

}  // namespace rtusim
