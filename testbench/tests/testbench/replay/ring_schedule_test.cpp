#include "testbench/replay/ring_schedule.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "modules/scheduler/policies/policies.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/schedule.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

using walked_type = walked_as<svo_walked, job_manager::stats>;
using ring = replaying::ring_schedule<svo_way>;
using followed = replaying::schedule<false, cyclic_first_available, svo_way>;

/// Rays of any cost, now and then a very dear one or a stack that overflows.
std::unique_ptr<walked_type> random_walks(test::rng& random, std::size_t count) {
  auto all = std::make_unique<walked_type>(count);
  const std::uint32_t most = 1u << random() % 10;
  for (std::size_t i = 0; i < count; ++i) {
    svo_walked& w = all->rays[i];
    w = {};
    w.job_word = random();
    w.cost = 2 + random() % most;
    if (random() % 500 == 0) w.cost += random() % 20'000;
    w.hit = random() % 2 == 0;
    w.t_hit = w.hit ? static_cast<std::int64_t>(random() % 100'000) : 0;
    w.axis = w.hit ? static_cast<std::int8_t>(random() % 3) : no_axis;
    w.pushes = w.cost / 6;
    w.depth = w.hit ? static_cast<std::uint8_t>(random() % 5) : 0;
    w.overflow = random() % 50'000 == 0;
  }
  all->jobs.jobs = count;
  return all;
}

/// Log and figures; `steps`: the jobs are walked in parts.
template <class Schedule>
std::string told(const design& d, const surroundings& s, const walked_type& walked, test::rng steps) {
  std::string log;
  const result_handler note = [&](cycle c, const traversal_result& any, std::uint64_t latency) {
    const auto& r = static_cast<const voxel_result&>(any);
    log += fmt::format("{},{},{},{},{},{},{},{}\n", c, latency, r.core, r.sequence, r.job_word, r.t_hit, r.normal_axis, r.normal_sign);
  };
  try {
    Schedule schedule(d, s, walked, note);
    for (std::size_t end = 0; end < walked.size();) schedule.advance(end = std::min(walked.size(), end + steps() % 500));
    config::report report;
    schedule.finish().describe(report);
    return log + report.values().dump();
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

TEST_CASE("ring schedule: where nothing is fed back it is the schedule that is followed job by job", "[replay]") {
  test::rng random(64);
  std::uint64_t refused = 0, rays = 0;
  for (int round = 0; round < 400; ++round) {
    design d;
    d.rtu.cores = random() % 8 == 0 ? 1 + random() % 1024 : 1 + random() % 80;
    d.result_manager_.valid_withdrawn = random() % 2 == 0;
    d.of<svo_kind>().core.stale_miss = random() % 2 == 0;
    surroundings s;
    if (random() % 8 == 0) s.watchdog_cycles = 1'000 + random() % 10'000;
    const auto all = random_walks(random, random() % 8 == 0 ? random() % 8 : random() % 3'000);
    const walked_type& walked = *all;
    CAPTURE(round, d.rtu.cores, walked.size(), s.watchdog_cycles);
    const test::rng steps(random());
    const std::string by_ring = told<ring>(d, s, walked, steps), by_jobs = told<followed>(d, s, walked, steps);
    REQUIRE(by_ring == by_jobs);
    refused += by_ring.find('{') == std::string::npos;
    rays += walked.size();
  }
  CHECK(rays > 200'000);
  CHECK(refused > 5);
  CHECK(refused < 100);
}

TEST_CASE("ring schedule: it stands for its regime alone, and the record tells what was followed", "[replay]") {
  const walked_type none(0);
  const result_handler nobody;
  const auto followed_in = [&](const design& d, const surroundings& s) {
    return replaying::schedule_for<svo_way>(d, s, none, nobody)->finish().followed;
  };
  const design d;
  const surroundings s;
  CHECK(followed_in(d, s) == "turns");
  design other = d, withdrawn = d;
  other.scheduler_.select = policy_index<round_robin>;
  CHECK(followed_in(other, s) == "jobs");
  surroundings gap = s, random = s;
  gap.source.valid = source_params::regime::gap;
  CHECK(followed_in(d, gap) == "jobs");
  random.sink.ready = sink_params::regime::lfsr;
  CHECK(followed_in(d, random) == "drains");
  withdrawn.result_manager_.valid_withdrawn = true;
  CHECK(followed_in(withdrawn, random) == "jobs");
}

}  // namespace rtusim
