#include <catch2/catch.hpp>

#include <algorithm>
#include <set>
#include <sstream>

#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/replay.h"
#include "testbench/run/job_file.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random.h"
#include "testbench/tests/random_scene.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/";

design as_built(unsigned cores) {
  design d;
  d.rtu.cores = cores;
  d.of<svo_kind>().conversion = {true, true, true};
  d.of<svo_kind>().core = test::as_built();
  d.result_manager_.valid_withdrawn = true;
  return d;
}

surroundings regime(const std::string& name) {
  surroundings s;
  if (name == "gap1") s.source.valid = source_params::regime::gap;
  if (name == "pace4") s.source.valid = source_params::regime::paced;
  if (name == "rnd") s.source.valid = source_params::regime::lfsr;
  if (name == "bp" || name == "rnd") s.sink.ready = sink_params::regime::lfsr;
  return s;
}

/// A run's log, as `--log` writes it, and after it its statistics.
struct outcome {
  std::string log;
  std::string statistics;
};

std::string log_line(cycle c, const traversal_result& any) {
  const auto& r = static_cast<const voxel_result&>(any);
  const int axis = r.normal_axis;
  return fmt::format("{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit), r.hit ? r.t_hit : 0, r.hit ? axis : -1,
                     r.cost, r.t_hit, axis);
}

constexpr char log_header[] = "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n";

outcome replay_of(const design& d, const surroundings& s, const svo_image& image, const std::vector<job_packet>& jobs,
                  bool kept_walks = false) {
  try {
    outcome o{log_header, ""};
    const auto note = [&](cycle c, const traversal_result& r, std::uint64_t) { o.log += log_line(c, r); };
    const svo_walker walk(d.of<svo_kind>(), image.words);
    const run_figures figures = kept_walks ? replay(d, s, walk, *walk_rays(walk, jobs, 2), note) : replay(d, s, walk, jobs, 2, note);
    config::report report;
    figures.describe(report);
    o.statistics = report.values().dump();
    return o;
  } catch (const std::exception& e) {
    return {std::string("error: ") + e.what(), ""};
  }
}

outcome simulate(const design& d, const surroundings& s, const svo_image& image, const std::vector<job_packet>& jobs, pace p,
                 std::uint32_t shuffle = 0, std::uint32_t change_pace = 0) {
  const std::string both = in_child([&] {
    simulation sim(d, s, svo_contents(image.words), jobs, p);
    sim.clock().shuffle_units(shuffle);
    std::string log = log_header;
    test::rng random(change_pace);
    sim.board().on_result([&](cycle c, const traversal_result& r, std::uint64_t) {
      log += log_line(c, r);
      if (change_pace != 0 && random() % 4 == 0) sim.clock().set_pace(static_cast<pace>(random() % 3));
    });
    sim.run();
    config::report report;
    sim.figures().describe(report);
    return log + '\0' + report.values().dump();
  });
  const auto split = both.find('\0');
  if (split == std::string::npos) return {both, ""};
  return {both.substr(0, split), both.substr(split + 1)};
}

}  // namespace

TEST_CASE("system: every log of the original hardware, in every pace", "[system]") {
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const auto jobs = read_jobs(golden + "sys/jobs_64x36_literal.bin.gz");
  struct row {
    const char* regime;
    unsigned cores;
  };
  const row rows[] = {{"ideal", 1}, {"ideal", 2}, {"ideal", 4},  {"ideal", 16}, {"gap1", 4},
                      {"pace4", 1}, {"pace4", 4}, {"pace4", 16}, {"bp", 2},     {"bp", 8}};
  for (const row& r : rows) {
    const std::string wanted = config::read_file(fmt::format("{}sys/log_64x36_literal_{}_c{}.csv.gz", golden, r.regime, r.cores));
    for (const pace p : {pace::skipping, pace::stepped, pace::checked}) {
      CAPTURE(r.regime, r.cores, static_cast<int>(p));
      CHECK((simulate(as_built(r.cores), regime(r.regime), image, jobs, p).log == wanted));
    }
    CHECK((replay_of(as_built(r.cores), regime(r.regime), image, jobs).log == wanted));
  }
}

TEST_CASE("system: every line of the totals, in cycles and checksum", "[system]") {
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const csv_table totals(golden + "sys/totals.csv");
  REQUIRE(totals.rows() == 12);
  for (std::size_t row = 0; row < totals.rows(); ++row) {
    const auto field = [&](const char* name) { return std::string(totals.field(row, totals.column(name))); };
    const auto jobs = read_jobs(fmt::format("{}sys/jobs_{}_literal.bin.gz", golden, field("frame")));
    const auto cores = static_cast<unsigned>(totals.number(row, totals.column("cores"), 1, 64));
    const outcome simulated = simulate(as_built(cores), regime(field("regime")), image, jobs, pace::skipping);
    const outcome replayed = replay_of(as_built(cores), regime(field("regime")), image, jobs);
    const auto s = nlohmann::json::parse(simulated.statistics);
    CAPTURE(row);
    CHECK((simulated.log == replayed.log));
    CHECK((simulated.statistics == replayed.statistics));
    CHECK(s["last_result_cycle"] == totals.number(row, totals.column("total_cycles"), 0, 1'000'000'000));
    CHECK(s["last_accept_cycle"] == totals.number(row, totals.column("last_accept_cycle"), 0, 1'000'000'000));
    CHECK(s["hits"] == totals.number(row, totals.column("hits"), 0, 1'000'000'000));
    CHECK(s["checksum"] == field("checksum"));
  }
}

TEST_CASE("system: any number of cores and any policy give the same set of results", "[system]") {
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const auto jobs = camera_jobs({}, {64, 36}, {}, 0);
  const auto results_of = [](const std::string& log) {
    std::set<std::string> results;
    std::istringstream lines(log);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) results.insert(line.substr(line.find(',', line.find(',') + 1)));  // without cycle and core
    return results;
  };
  std::set<std::string> first;
  for (const unsigned cores : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 16u, 24u, 64u}) {
    for (unsigned policy = 0; policy < scheduler_policies::count; ++policy) {
      design d;
      d.rtu.cores = cores;
      d.scheduler_.select = policy;
      const auto results = results_of(simulate(d, {}, image, jobs, pace::skipping).log);
      REQUIRE(results.size() == jobs.size());
      if (first.empty()) first = results;
      CAPTURE(cores, policy);
      CHECK((results == first));
    }
  }
}

TEST_CASE("system: 500 random designs and streams are the same in every pace, whatever the order of the units", "[system]") {
  test::rng random(2026);
  std::size_t errors = 0;
  for (int round = 0; round < 500; ++round) {
    design d;
    d.rtu.cores = random() % 4 == 0 ? 1 + random() % 64 : 1 + random() % 9;
    d.scheduler_.select = random() % scheduler_policies::count;
    d.of<svo_kind>().core = test::random_core(random);
    d.of<svo_kind>().format = d.of<svo_kind>().core.format;
    d.of<svo_kind>().conversion = {random() % 2 == 0, random() % 2 == 0, random() % 2 == 0};
    d.result_manager_.valid_withdrawn = random() % 2 == 0;
    surroundings s;
    s.watchdog_cycles = 20'000;
    s.source.valid = static_cast<source_params::regime>(random() % 4);
    s.source.gap_cycles = 1 + random() % (random() % 8 == 0 ? 2'000 : 4);
    s.source.interval_cycles = 1 + random() % 12;
    s.source.seed = static_cast<std::uint16_t>(1 + random() % 65'535);
    s.sink.ready = static_cast<sink_params::regime>(random() % 2);
    s.sink.seed = static_cast<std::uint16_t>(1 + random() % 65'535);
    const svo_image image = test::random_image(random);
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0, n = 1 + random() % 150; id < n; ++id) jobs.push_back(test::random_packet(random, id));

    CAPTURE(round, d.rtu.cores, d.scheduler_.select, static_cast<int>(s.source.valid), static_cast<int>(s.sink.ready));
    const outcome skipping = simulate(d, s, image, jobs, pace::skipping);
    const outcome other = simulate(d, s, image, jobs, round % 5 == 0 ? pace::checked : pace::stepped);
    REQUIRE(skipping.log == other.log);
    REQUIRE(skipping.statistics == other.statistics);
    const outcome shuffled = simulate(d, s, image, jobs, pace::skipping, 1 + random());
    REQUIRE(skipping.log == shuffled.log);
    const outcome changing = simulate(d, s, image, jobs, pace::skipping, 0, 1 + random());
    REQUIRE(skipping.log == changing.log);
    REQUIRE(skipping.statistics == changing.statistics);
    const outcome replayed = replay_of(d, s, image, jobs, round % 2 == 0);
    REQUIRE(skipping.log == replayed.log);
    REQUIRE(skipping.statistics == replayed.statistics);
    REQUIRE(skipping.statistics == shuffled.statistics);
    if (skipping.statistics.empty()) {
      REQUIRE_THAT(skipping.log, Catch::Contains("overflows"));
      ++errors;
    }
  }
  CHECK(errors < 150);
}

TEST_CASE("system: a run that can never finish says who waits for whom", "[system]") {
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const auto jobs = read_jobs(golden + "sys/jobs_64x36_literal.bin.gz");
  surroundings s;
  s.watchdog_cycles = 5'000;
  s.sink.ready = sink_params::regime::blocked;
  for (const pace p : {pace::skipping, pace::stepped}) {
    const outcome o = simulate(as_built(2), s, image, jobs, p);
    CHECK_THAT(o.log, Catch::Contains("error: no transfer in the 5000 cycles after cycle"));
    CHECK_THAT(o.log, Catch::Contains("job: source waits for job_manager"));
    CHECK_THAT(o.log, Catch::Contains("pending_job: job_manager waits for scheduler"));
    CHECK_THAT(o.log, Catch::Contains("core_result_0: core_0 waits for result_manager"));
    CHECK_THAT(o.log, Catch::Contains("result: result_manager waits for sink"));
  }
}

TEST_CASE("system: the law of the ideal regime", "[system]") {
  // Sum over jobs of ceil((cost + 2) / N) + N + 5, one more at most (reference of the as-built schedule).
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const auto jobs = read_jobs(golden + "sys/jobs_64x36_literal.bin.gz");
  for (const unsigned cores : {1u, 4u, 16u}) {
    const outcome o = simulate(as_built(cores), {}, image, jobs, pace::skipping);
    const auto s = nlohmann::json::parse(o.statistics);
    std::uint64_t law = cores + 5;
    for (const auto& pair : s["cost"]["histogram"])
      law += (pair[0].get<std::uint64_t>() + 2 + cores - 1) / cores * pair[1].get<std::uint64_t>();
    const auto total = s["last_result_cycle"].get<std::uint64_t>();
    CHECK(total >= law - 1);
    CHECK(total <= law + 1);
  }
}

}  // namespace rtusim
