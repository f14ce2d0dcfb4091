// A third kind of core, in this folder alone and with one line in each of the two lists, goes through every command.

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/files.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

using json = nlohmann::json;
using test::words;

words with(words all, const words& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

const words run{"run", "--quiet", "--set", "rtu.core=probe", "--set", "frame.width=40", "--set", "frame.height=24"};

void succeeds(const std::filesystem::path& folder, const words& arguments) {
  const test::outcome o = test::rtusim(folder, arguments);
  CAPTURE(o.out);
  CHECK(o.err == "");
  REQUIRE(o.status == 0);
}

json record(const std::filesystem::path& file) { return json::parse(config::read_file(file)); }

}  // namespace

TEST_CASE("probe core: every pace gives the same log and figures, as the walk of each ray has it") {
  const test::scratch_folder folder;
  for (const std::string sink : {"always", "lfsr"})
    for (const int cores : {1, 5}) {
      std::string log;
      json statistics;
      for (const std::string pace : {"skipping", "stepped", "checked", "replay"}) {
        CAPTURE(sink, cores, pace);
        succeeds(folder, with(run, {"--set", fmt::format("rtu.cores={}", cores), "--set", "sink.ready=" + sink, "--set",
                                    "probe_core.latency_cycles=9", "--pace", pace, "--log", "log.csv", "--stats", "stats.json"}));
        const std::string found = config::read_file(folder / "log.csv");
        const json s = record(folder / "stats.json")["statistics"];
        if (log.empty()) log = found, statistics = s;
        CHECK(found == log);
        CHECK(s == statistics);
      }
      CHECK(statistics["rays"] == 960);
      CHECK(statistics["probe_core"]["jobs"] == 960);
      CHECK(statistics["probe_core"]["cycles"]["walk"] == 960 * 9);
      CHECK(statistics["hits"] == statistics["probe_core"]["hits"]);
      const unsigned hits = statistics["hits"];
      CHECK(hits > 100);
      CHECK(hits < 900);
      std::istringstream lines(log);
      std::string line;
      REQUIRE(std::getline(lines, line));
      CHECK(line == "cycle,core,job_id,hit,t_hit,cost");
      unsigned of_log = 0;
      while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        std::uint64_t cycle = 0, core = 0, job = 0, hit = 0, t = 0, cost = 0;
        REQUIRE(fields >> cycle >> core >> job >> hit >> t >> cost);
        CHECK(cost == 9);
        of_log += hit == 1;
      }
      CHECK(of_log == hits);
    }
}

TEST_CASE("probe core: pictures, a waveform, a record that is run again") {
  const test::scratch_folder folder;
  succeeds(folder, with(run, {"--image", "a.png", "--image", "a.sheet.png", "--image", "a.exr", "--vcd", "a.vcd", "--vcd-to", "50",
                              "--stats", "stats.json"}));
  for (const char* name : {"a.png", "a.sheet.png", "a.exr"}) CHECK(std::filesystem::file_size(folder / name) > 200);
  const std::string waveform = config::read_file(folder / "a.vcd");
  CHECK(waveform.find("core_15") != std::string::npos);
  succeeds(folder, {"rerun", "stats.json", "--quiet"});
  const test::outcome summary =
      test::rtusim(folder, {"run", "--set", "rtu.core=probe", "--set", "frame.width=8", "--set", "frame.height=8"});
  CHECK_THAT(summary.out, Catch::Contains("16 probe cores"));
}

TEST_CASE("probe core: a sweep over its latency has other cycles for each") {
  const test::scratch_folder folder;
  folder.file("scene.toml", "[frame]\nwidth = 16\nheight = 9\n");
  folder.file(
      "sweep.toml",
      "[sweep]\nscenes = [\"scene.toml\"]\nrecord = [\"total_cycles\", \"probe_core.cost_cycles\"]\n[set]\n\"rtu.core\" = \"probe\"\n"
      "\"rtu.cores\" = 2\n[axes]\n\"probe_core.latency_cycles\" = [1, 4, 16, 64]\n");
  const test::outcome refused = test::rtusim(folder, {"sweep", "sweep.toml", "--quiet"});
  CHECK(refused.status == 2);
  CHECK_THAT(refused.err, Catch::Contains("no figure probe_core.cost_cycles"));
  folder.file(
      "sweep.toml",
      "[sweep]\nscenes = [\"scene.toml\"]\nrecord = [\"total_cycles\", \"probe_core.cycles.walk\"]\n[set]\n\"rtu.core\" = \"probe\"\n"
      "\"rtu.cores\" = 2\n[axes]\n\"probe_core.latency_cycles\" = [1, 4, 16, 64]\n");
  succeeds(folder, {"sweep", "sweep.toml", "--quiet"});
  const json results = record(folder / "out/sweep/results.json");
  double before = 0;
  REQUIRE(results["points"].size() == 4);
  for (const json& p : results["points"]) {
    CHECK(p["status"] == "done");
    const double latency = p["axes"]["probe_core.latency_cycles"];
    CHECK(p["figures"]["probe_core.cycles.walk"] == latency * 16 * 9);
    CHECK(p["figures"]["total_cycles"] > before);
    before = p["figures"]["total_cycles"];
  }
}

TEST_CASE("probe core: it is explained, and runs alone") {
  const test::scratch_folder folder;
  CHECK_THAT(test::rtusim(folder, {"explain", "probe_core"}).out, Catch::Contains("probe_core.latency_cycles"));
  CHECK_THAT(test::rtusim(folder, {"explain", "statistics.probe_core"}).out, Catch::Contains("at work"));
  CHECK_THAT(test::rtusim(folder, {"explain", "rtu.core"}).out, Catch::Contains("probe"));
  folder.file("jobs.csv", "id,t0x,t0y,t0z,t1x,t1y,t1z\n7,1,2,3,9,9,9\n8,1,2,30,9,9,9\n");
  succeeds(folder, {"unit", "probe_core", "--jobs", "jobs.csv", "--out", "out.csv"});
  CHECK(config::read_file(folder / "out.csv") == "id,t0x,t0y,t0z,t1x,t1y,t1z,hit,t\n7,1,2,3,9,9,9,1,3\n8,1,2,30,9,9,9,0,0\n");
  const test::outcome unknown = test::rtusim(folder, {"unit", "prob_core", "--jobs", "jobs.csv", "--out", "out.csv"});
  CHECK_THAT(unknown.err, Catch::Contains("or probe_core"));
}

}  // namespace rtusim
