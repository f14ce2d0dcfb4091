// Patterns and the calendar at known values, and where their words and wheels end.

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <vector>

#include "modules/timing/calendar.h"
#include "modules/timing/rotating_select.h"
#include "testbench/bench/lfsr.h"

namespace rtusim {

TEST_CASE("lfsr: its first values, its period, its longest runs", "[timing]") {
  const std::vector<std::uint16_t> of_one{0x0001, 0xB400, 0x5A00, 0x2D00, 0x1680, 0x0B40, 0x05A0,
                                          0x02D0, 0x0168, 0x00B4, 0x005A, 0x002D, 0xB416, 0x5A0B};
  const std::vector<std::uint16_t> of_sink{0xACE1, 0xE270, 0x7138, 0x389C, 0x1C4E, 0x0E27, 0xB313};
  const lfsr one(1), sink(0xACE1);
  for (std::size_t i = 0; i < of_one.size(); ++i) CHECK(one.state(i) == of_one[i]);
  for (std::size_t i = 0; i < of_sink.size(); ++i) CHECK(sink.state(i) == of_sink[i]);
  std::vector<unsigned> seen(65'536);
  for (cycle c = 0; c < 65'535; ++c) ++seen[one.state(c)];
  CHECK(seen[0] == 0);
  for (unsigned value = 1; value < seen.size(); ++value) REQUIRE(seen[value] == 1);
  CHECK(one.state(65'535) == 1);
  CHECK(one.state(65'536) == 0xB400);
  CHECK(one.state(std::uint64_t{65'535} * 1'000'000'007 + 2) == 0x5A00);
  // Of seed 1, bit 0 is 1 in cycle 0 and next in cycle 11.
  CHECK(one.next(0) == 0);
  CHECK(one.next(1) == 11);
  CHECK(one.next(11) == 11);
  CHECK(one.next(12) == 13);
  CHECK(one.next(65'534) == one.next(65'535 * 3 - 1) - 2 * cycle{65'535});
  CHECK(one.next(65'535) == 65'535);
  CHECK(one.count(0, 0) == 0);
  CHECK(one.count(0, 1) == 1);
  CHECK(one.count(1, 11) == 0);
  CHECK(one.count(0, 12) == 2);
  CHECK(one.count(5, 5) == 0);
  CHECK(one.count(6, 5) == 0);
  CHECK(one.count(0, 65'535) == 32'768);
  CHECK(one.count(7, 65'542) == 32'768);
  CHECK(one.count(0, 65'536) == 32'769);
  CHECK(one.count(0, 3 * 65'535 + 12) == 3 * 32'768 + 2);
  // A maximal sequence has one run of 16 ones and one of 15 zeros.
  unsigned ones = 0, zeros = 0, most_ones = 0, most_zeros = 0;
  for (cycle c = 0; c < 2 * 65'535; ++c) {
    const bool bit = (one.state(c) & 1) != 0;
    ones = bit ? ones + 1 : 0;
    zeros = bit ? 0 : zeros + 1;
    most_ones = std::max(most_ones, ones);
    most_zeros = std::max(most_zeros, zeros);
  }
  CHECK(most_ones == 16);
  CHECK(most_zeros == 15);
}

TEST_CASE("rotating_select: one line, four, and those at the ends of words", "[timing]") {
  rotating_select one(1);
  CHECK(one.selected(0) == 0);
  CHECK(one.selected(12'345) == 0);
  CHECK_FALSE(one.any());
  CHECK(one.next(5) == never);
  CHECK(one.count(0, 100) == 0);
  one.set_line(0, true);
  one.set_line(0, true);  // again
  CHECK(one.any());
  CHECK(one.lowest() == 0);
  CHECK(one.next(5) == 5);
  CHECK(one.next(never) == never);
  CHECK(one.count(3, 100) == 97);
  one.select(0, 77);
  CHECK(one.selected(78) == 0);
  one.set_line(0, false);
  CHECK_FALSE(one.any());

  rotating_select four(4);
  CHECK(four.selected(0) == 0);
  CHECK(four.selected(7) == 3);
  four.set_line(2, true);
  four.select(1, 10);
  CHECK(four.selected(10) == 1);
  CHECK(four.selected(13) == 0);
  CHECK(four.selected(9) == 0);  // before
  CHECK(four.next(10) == 11);
  CHECK(four.next(11) == 11);
  CHECK(four.next(12) == 15);
  CHECK(four.count(11, 11) == 0);
  CHECK(four.count(11, 12) == 1);
  CHECK(four.count(12, 15) == 0);
  CHECK(four.count(12, 16) == 1);
  CHECK(four.count(10, 14) == 1);
  CHECK(four.count(11, 16) == 2);
  four.set_line(3, true);
  CHECK(four.count(11, 16) == 3);
  CHECK(four.next(13) == 15);
  CHECK(four.lowest() == 2);

  for (const unsigned lines : {63u, 64u, 65u, 128u, 129u, 1024u}) {
    CAPTURE(lines);
    rotating_select s(lines);
    const unsigned last = lines - 1;
    s.set_line(last, true);
    CHECK(s.lowest() == last);
    CHECK(s.next(0) == last);
    CHECK(s.next(last + 1) == 2 * lines - 1);
    CHECK(s.count(0, last) == 0);
    CHECK(s.count(0, lines) == 1);
    CHECK(s.count(last, 2 * lines) == 2);
    s.set_line(0, true);
    CHECK(s.lowest() == 0);
    CHECK(s.next(1) == last);
    CHECK(s.next(lines) == lines);
    CHECK(s.count(last, lines + 1) == 2);
    s.set_line(last, false);
    CHECK(s.next(1) == lines);
    s.select(last, 1'000'003);
    CHECK(s.selected(1'000'003) == last);
    CHECK(s.next(1'000'003) == 1'000'004);
  }
}

TEST_CASE("calendar: bookings at the wheel's end, on it and beyond", "[timing]") {
  constexpr cycle wheel = 1024;
  const auto due = [](calendar& c, cycle at) {
    std::set<booking*> all;
    c.take(at, [&](booking& b) {
      CHECK(b.at == at);
      b.at = never;
      all.insert(&b);
    });
    return all;
  };
  using list = std::set<booking*>;
  for (const cycle begin : {cycle{0}, cycle{1}, cycle{63}, cycle{64}, cycle{1000}, cycle{1023}, cycle{1024}, cycle{123'456}}) {
    CAPTURE(begin);
    calendar c;
    booking now(booking::what::channel), last(booking::what::unit), on_end(booking::what::channel), behind(booking::what::unit),
        far(booking::what::channel);
    CHECK(c.earliest() == never);
    CHECK(due(c, begin).empty());
    c.book(far, begin + 5 * wheel);
    CHECK(c.earliest() == begin + 5 * wheel);
    c.book(behind, begin + wheel + 1);
    CHECK(c.earliest() == begin + wheel + 1);
    c.book(on_end, begin + wheel);  // in the slot of `now`
    CHECK(c.earliest() == begin + wheel);
    c.book(last, begin + wheel - 1);
    CHECK(c.earliest() == begin + wheel - 1);
    c.book(now, begin);
    CHECK(c.earliest() == begin);
    CHECK(due(c, begin) == list{&now});
    CHECK(now.at == never);
    CHECK(c.earliest() == begin + wheel - 1);
    CHECK(due(c, begin + wheel - 1) == list{&last});
    CHECK(c.earliest() == begin + wheel);
    c.book(last, begin + wheel);
    CHECK(due(c, begin + wheel) == list{&last, &on_end});
    CHECK(due(c, begin + wheel + 1) == list{&behind});
    CHECK(c.earliest() == begin + 5 * wheel);
    CHECK(due(c, begin + 4 * wheel).empty());  // the same slot, a turn before
    CHECK(c.earliest() == begin + 5 * wheel);
    // Moved from the wheel behind it and back, and taken back from either.
    c.book(far, begin + 4 * wheel + 1);
    CHECK(c.earliest() == begin + 4 * wheel + 1);
    c.book(far, begin + 9 * wheel);
    CHECK(c.earliest() == begin + 9 * wheel);
    c.book(now, begin + 4 * wheel + 5);
    c.book(now, never);
    CHECK(c.earliest() == begin + 9 * wheel);
    c.book(far, never);
    CHECK(c.earliest() == never);
    CHECK(due(c, begin + 9 * wheel).empty());
  }
}

}  // namespace rtusim
