#include "testbench/run/interrupts.h"

#include <catch2/catch.hpp>

#include <csignal>

namespace rtusim {
namespace {

volatile std::sig_atomic_t others = 0;
extern "C" void note_other(int) { ++others; }

}  // namespace

TEST_CASE("interrupts: each of the three is noted while this lives, and no longer", "[testbench]") {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    CAPTURE(number);
    others = 0;
    const auto before = std::signal(number, note_other);
    {
      const interrupts noting;
      CHECK_FALSE(interrupts::came());
      std::raise(number);
      CHECK(interrupts::came());
      CHECK(others == 0);
    }
    std::raise(number);
    CHECK(others == 1);
    {
      // What came to the last one is forgotten.
      const interrupts noting;
      CHECK_FALSE(interrupts::came());
    }
    std::signal(number, before);
  }
}

TEST_CASE("interrupts: a signal that is ignored stays so", "[testbench]") {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  {
    const interrupts noting;
    std::raise(SIGHUP);
    CHECK_FALSE(interrupts::came());
  }
  CHECK(std::signal(SIGHUP, before) == SIG_IGN);
}

}  // namespace rtusim
