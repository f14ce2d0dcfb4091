// How long a run may go without a transfer, to the cycle.

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/svo_core/svo_kind.h"
#include "modules/timing/clock_domain.h"
#include "testbench/bench/simulation.h"
#include "testbench/bench/stream.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/replay.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

using Catch::StartsWith;

struct recorder {
  std::string text;
  void transferred(unsigned, cycle c, const std::uint32_t& item) { text += fmt::format("{}@{} ", item, c); }
};

/// Three items straight from a source to a sink: which went when, and why the run ended before its end.
std::string run(pace p, const source_params& source_p, cycle watchdog, sink_params::regime ready = sink_params::regime::always) {
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    const std::vector<std::uint32_t> items{7, 8, 9};
    sink_params sink_p;
    sink_p.ready = ready;
    stream_source<std::uint32_t> source("source", source_p, items);
    stream_sink<std::uint32_t> sink("sink", sink_p, items.size());
    channel<std::uint32_t> between("between");
    recorder seen;
    source.out(between);
    sink.in(between);
    between.observe(seen, 0);
    clock.set_pace(p);
    clock.set_watchdog(watchdog);
    try {
      clock.start();
    } catch (const simulation_error& e) {
      seen.text += e.what();
    }
    return seen.text;
  });
}

constexpr pace paces[] = {pace::skipping, pace::stepped, pace::checked};

source_params paced(unsigned interval) {
  source_params p;
  p.valid = source_params::regime::paced;
  p.interval_cycles = interval;
  return p;
}

}  // namespace

TEST_CASE("watchdog: transfers as far apart as it allows, and one cycle more", "[timing]") {
  for (const pace p : paces) {
    CAPTURE(static_cast<int>(p));
    CHECK(run(p, paced(50), 50) == "7@0 8@50 9@100 ");
    CHECK_THAT(run(p, paced(51), 50), StartsWith("7@0 no transfer in the 50 cycles after cycle 0: "));
    CHECK(run(p, paced(52), 50) == "7@0 no transfer in the 50 cycles after cycle 0: no channel is valid, so a source gives nothing more");
    CHECK(run(p, paced(1), 1) == "7@0 8@1 9@2 ");
    CHECK_THAT(run(p, paced(2), 1), StartsWith("7@0 no transfer in the 1 cycles after cycle 0: "));
    source_params gap;
    gap.valid = source_params::regime::gap;
    gap.gap_cycles = 1999;
    CHECK(run(p, gap, 2000) == "7@0 8@2000 9@4000 ");
    CHECK_THAT(run(p, gap, 1999), StartsWith("7@0 no transfer in the 1999 cycles after cycle 0: "));
    // Who waits for whom.
    CHECK(run(p, paced(50), 50, sink_params::regime::blocked) ==
          "no transfer in the 50 cycles after cycle 0: between: source waits for sink");
  }
}

TEST_CASE("clock_domain: transfers at and around the length of the calendar's wheel", "[timing]") {
  for (const pace p : paces)
    for (const unsigned interval : {1023u, 1024u, 1025u, 2047u, 2048u, 2049u, 10'000u}) {
      CAPTURE(static_cast<int>(p), interval);
      CHECK(run(p, paced(interval), 1'000'000) == fmt::format("7@0 8@{} 9@{} ", interval, 2 * interval));
    }
}

TEST_CASE("watchdog: a replay allows no more than a simulation does", "[timing]") {
  // An octree of one filled voxel, and rays of zeros.
  const std::vector<std::uint32_t> octree{0x00000101};
  const std::vector<job_packet> jobs(2);
  constexpr unsigned interval = 5000;
  design d;
  d.rtu.cores = 1;
  surroundings s;
  s.source = paced(interval);
  const auto simulated = [&](cycle watchdog, cycle& result) {
    s.watchdog_cycles = watchdog;
    const std::string text = in_child([&] {
      cycle first = 0;
      simulation sim(d, s, svo_contents(octree), jobs, pace::skipping);
      sim.board().on_result([&](cycle c, const traversal_result&, std::uint64_t) {
        if (first == 0) first = c;
      });
      sim.run();
      return fmt::format("{}", first);
    });
    result = text.rfind("error", 0) == 0 ? 0 : std::stoull(text);
    return text.substr(0, text.find(':', 7));
  };
  const auto replayed = [&](cycle watchdog) {
    s.watchdog_cycles = watchdog;
    try {
      replay(d, s, svo_walker(d.of<svo_kind>(), octree), jobs, 1, {});
      return true;
    } catch (const input_error&) {
      return false;
    }
  };
  cycle result = 0, ignored = 0;
  simulated(1'000'000, result);
  REQUIRE(result > 0);
  const cycle longest = interval - result;  // to the next job's acceptance
  simulated(longest, ignored);
  CHECK(ignored == result);
  CHECK(simulated(longest - 1, ignored) == fmt::format("error: no transfer in the {} cycles after cycle {}", longest - 1, result));
  // It looks at the dispatches alone.
  CHECK(replayed(interval));
  CHECK_FALSE(replayed(interval - 1));
  CHECK_FALSE(replayed(longest - 1));
}

}  // namespace rtusim
