#include "modules/timing/calendar.h"

#include <catch2/catch.hpp>

#include <deque>
#include <map>
#include <set>
#include "testbench/tests/random.h"

namespace rtusim {

TEST_CASE("calendar: as a sorted map of bookings, near and far, moved and taken back", "[timing]") {
  test::rng random(7);
  for (const cycle reach : {cycle{3}, cycle{200}, cycle{1024}, cycle{5000}}) {
    calendar c;
    std::deque<booking> bookings;
    for (int i = 0; i < 40; ++i) bookings.emplace_back(booking::what::channel);
    std::map<const booking*, cycle> expected;
    cycle now = 0;
    for (int step = 0; step < 20'000; ++step) {
      for (unsigned n = random() % 4; n > 0; --n) {
        booking& b = bookings[random() % bookings.size()];
        const cycle at = random() % 8 == 0 ? never : now + random() % reach;
        c.book(b, at);
        expected.erase(&b);
        if (at != never) expected[&b] = at;
      }
      cycle least = never;
      for (const auto& [b, at] : expected) least = std::min(least, at);
      REQUIRE(c.earliest() == least);
      // Sometimes a cycle without a booking is taken, as in the stepped pace.
      const cycle next = random() % 2 == 0 || least == never ? std::min(least, now + 1) : least;
      if (next == never) continue;
      now = next;
      std::set<const booking*> due;
      c.take(now, [&](booking& b) {
        CHECK(b.at == now);
        b.at = never;
        due.insert(&b);
      });
      std::set<const booking*> wanted;
      for (auto it = expected.begin(); it != expected.end();) {
        if (it->second == now) {
          wanted.insert(it->first);
          it = expected.erase(it);
        } else {
          ++it;
        }
      }
      REQUIRE(due == wanted);
      ++now;
    }
  }
}

}  // namespace rtusim
