#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "testbench/run/program_version.h"
#include "testbench/run/summary.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

// The page that a run prints: every number on it is the record's.
namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
using test::words;

const std::string source = RTUSIM_SOURCE_DIR "/";

/// A record in which no two figures are alike.
run_record made_up(unsigned cores) {
  run_record r;
  r.inputs = {{"architecture", "arch.toml"}, {"model", "a.svo"}, {"model_words", 685}};
  r.parameters["rtu"] = {{"core", "svo"}, {"cores", cores}, {"clock_mhz", 233.5}};
  r.statistics = json::parse(R"({
    "total_cycles": 7020, "last_result_cycle": 7019, "last_accept_cycle": 7001, "rays": 1296, "hits": 169,
    "cycles_per_ray": 5.41678, "rays_per_cycle": 0.18461, "seconds": 0.0123456, "rays_per_second": 18461538.4, "frames_per_second": 81.0049,
    "latency": {"mean": 48.66, "least": 12, "p50": 24, "p90": 119, "p99": 172, "most": 200},
    "cost": {"mean": 12.5, "least": 2, "p50": 3, "p90": 38, "p99": 77, "most": 98},
    "waits": {"conversion": 6.004, "dispatch": 26.4375, "traversal": 13.52932, "buffer": 0.486, "result": 48.66},
    "svo_core": {"jobs": 991, "hits": 1, "cost": 2,
       "cycles": {"idle": 167, "init": 1, "eval": 300, "next": 100, "push": 200, "pop": 170, "out": 62}},
    "channels": {
      "pending_job": {"transferred": 5, "starved": 10, "back_pressured": 25, "idle": 60},
      "job": {"transferred": 185, "starved": 2, "back_pressured": 812, "idle": 1},
      "result": {"transferred": 400, "starved": 300, "back_pressured": 200, "idle": 100},
      "core_job_0": {"transferred": 1, "starved": 1, "back_pressured": 1, "idle": 1}}})");
  for (unsigned i = 0; i < cores; ++i)
    r.statistics["core_" + std::to_string(i)] = {
        {"jobs", 400 + i}, {"hits", 9}, {"cost", 8}, {"cycles", {{"idle", 10 + i}, {"eval", 960 - 2 * i}, {"out", 30 + i}}}};
  r.simulator = {{"pace", "skipping"},
                 {"run_seconds", 0.25},
                 {"all_seconds", 1.6489},
                 {"rays_per_second", 775108.5},
                 {"cycles_per_second", 4198504.3},
                 {"ns_per_ray", 1290.1},
                 {"edges", 2565},
                 {"edges_per_ray", 1.979167}};
  return r;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

/// A line in the C library's format; by that and not by the program's own.
template <class... Values>
std::string printed(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

TEST_CASE("summary: a whole page of voxel cores", "[summary]") {
  const char* const page =
      "2 svo cores at 233.5 MHz, a.svo on 685 words\n"
      "          7020 cycles   1296 rays, 169 hits (13.0 %)\n"
      "         5.417 cycles a ray\n"
      "        18.462 M rays/s and 81.00 frames/s at the clock (12.346 ms)\n"
      "\n"
      "latency of a ray, cycles: mean 48.7, half within 24, 99 % within 172, most 200\n"
      "    conversion     6.00  ######............................................\n"
      "      dispatch    26.44  ###########################.......................\n"
      "     traversal    13.53  ##############....................................\n"
      "        buffer     0.49  ..................................................\n"
      "        result    48.66  ##################################################\n"
      "\n"
      "cores, share of all cycles:  idle   walk    out   jobs\n"
      "                        all  16.7%  77.1%   6.2%    991\n"
      "                     core_0   1.0%  96.0%   3.0%    400\n"
      "                     core_1   1.1%  95.8%   3.1%    401\n"
      "\n"
      "channels, share of all cycles:  transferred  starved  back-pressured   idle\n"
      "                           job        18.5%     0.2%           81.2%   0.1%\n"
      "                   pending_job         5.0%    10.0%           25.0%  60.0%\n"
      "                        result        40.0%    30.0%           20.0%  10.0%\n"
      "\n"
      "simulated in 0.250 s (skipping with everything: 1.649 s): 0.78 M rays/s, 4.20 M cycles/s, 1.98 edges a ray\n";
  CHECK(summary_text(made_up(2)) == page);
}

TEST_CASE("summary: triangle cores have a fill and no cycles of handing over; a design by default is told", "[summary]") {
  run_record r = made_up(1);
  r.inputs = {{"architecture", ""}, {"model", "b.obj"}, {"model_triangles", 6320}};
  r.parameters["rtu"]["core"] = "bih";
  r.statistics["bih_core"] = {{"jobs", 242}, {"fill", 0.40649}, {"cycles", {{"idle", 25}, {"aabb", 50}, {"leaf", 925}}}};
  r.statistics["core_0"] = {{"jobs", 241}, {"fill", 0.9}, {"cycles", {{"idle", 50}, {"aabb", 450}, {"leaf", 500}}}};
  const auto lines = lines_of(summary_text(r));
  REQUIRE(lines.size() == 24);
  CHECK(lines[0] == "1 bih cores at 233.5 MHz, b.obj on 6320 triangles");
  CHECK(lines[1] == "no --arch: the default design (testbench/architectures/espe2019.toml) with what --set changes");
  CHECK(lines[14] == "                        all   2.5%  97.5%   0.0%    242");
  CHECK(lines[15] == "                     core_0   5.0%  95.0%   0.0%    241");
  CHECK(lines[16] == "                       fill  40.6% of the cores' walking cycles issue a triangle");
}

TEST_CASE("summary: up to 16 cores all are told, of more the first and the last four", "[summary]") {
  const auto told = [](unsigned cores) {
    std::vector<std::string> all;
    const std::regex core("^ +(core_\\d+) .*");
    std::smatch found;
    for (const std::string& line : lines_of(summary_text(made_up(cores))))
      if (std::regex_match(line, found, core)) all.push_back(found[1]);
    return all;
  };
  CHECK(told(16).size() == 16);
  CHECK(told(17) == std::vector<std::string>{"core_0", "core_1", "core_2", "core_3", "core_13", "core_14", "core_15", "core_16"});
}

TEST_CASE("summary: what a run prints is what its record says", "[summary]") {
  const test::scratch_folder folder;
  const std::string voxels = source + "testbench/golden/svo/models/dragon_32.svo", mesh = source + "testbench/tests/cases/mesh_cube.obj";
  const words runs[] = {
      {"run", "--model", voxels, "--set", "rtu.cores=3"},
      {"run", "--model", voxels, "--arch", source + "testbench/architectures/espe2019_as_built.toml", "--set", "rtu.cores=18", "--set",
       "sink.ready=lfsr"},
      {"run", "--model", mesh, "--arch", source + "testbench/architectures/hanika2007.toml", "--set", "rtu.cores=2"},
  };
  for (words run : runs) {
    for (const char* also : {"--set", "frame.width=40", "--set", "frame.height=24", "--stats", "s.json"}) run.emplace_back(also);
    CAPTURE(run);
    const test::outcome o = test::rtusim(folder, run);
    REQUIRE(o.status == 0);
    const json record = json::parse(test::bytes_of(folder / "s.json"));
    const json& s = record["statistics"];
    const bool triangles = record["parameters"]["rtu"]["core"] == "bih";
    const auto number = [](const json& j) { return j.get<double>(); };
    const auto whole = [](const json& j) { return j.get<unsigned long long>(); };

    std::vector<std::string> page;
    page.push_back(printed("%llu %s cores at %g MHz, %s on %llu %s", whole(record["parameters"]["rtu"]["cores"]), triangles ? "bih" : "svo",
                           number(record["parameters"]["rtu"]["clock_mhz"]), (triangles ? mesh : voxels).c_str(),
                           whole(record["inputs"][triangles ? "model_triangles" : "model_words"]), triangles ? "triangles" : "words"));
    if (record["inputs"]["architecture"] == "")
      page.emplace_back("no --arch: the default design (testbench/architectures/espe2019.toml) with what --set changes");
    const double cycles = number(s["total_cycles"]), rays = number(s["rays"]),
                 hertz = 1e6 * number(record["parameters"]["rtu"]["clock_mhz"]);
    page.push_back(
        printed("%14.0f cycles   %.0f rays, %.0f hits (%.1f %%)", cycles, rays, number(s["hits"]), 100 * number(s["hits"]) / rays));
    page.push_back(printed("%14.3f cycles a ray", cycles / rays));
    page.push_back(printed("%14.3f M rays/s and %.2f frames/s at the clock (%.3f ms)", rays / cycles * hertz / 1e6, hertz / cycles,
                           1e3 * cycles / hertz));
    page.emplace_back();
    const json& latency = s["latency"];
    page.push_back(printed("latency of a ray, cycles: mean %.1f, half within %llu, 99 %% within %llu, most %llu", number(latency["mean"]),
                           whole(latency["p50"]), whole(latency["p99"]), whole(latency["most"])));
    double all_waits = 0;
    for (const char* name : {"conversion", "dispatch", "traversal", "buffer", "result"}) {
      const double wait = number(s["waits"][name]);
      all_waits += wait;
      const auto filled = static_cast<std::size_t>(std::lround(50 * wait / number(latency["mean"])));
      page.push_back(printed("%14s %8.2f  ", name, wait) + std::string(filled, '#') + std::string(50 - filled, '.'));
    }
    CHECK(all_waits == Approx(number(latency["mean"])));
    page.emplace_back();
    page.emplace_back("cores, share of all cycles:  idle   walk    out   jobs");
    const auto core_line = [&](const std::string& name, const json& core, double of) {
      const double out = triangles ? 0 : number(core["cycles"]["out"]), idle = number(core["cycles"]["idle"]);
      page.push_back(printed("%27s %5.1f%% %5.1f%% %5.1f%% %6llu", name.c_str(), 100 * idle / of, 100 * (of - idle - out) / of,
                             100 * out / of, whole(core["jobs"])));
    };
    const auto cores = record["parameters"]["rtu"]["cores"].get<unsigned>();
    core_line("all", s[triangles ? "bih_core" : "svo_core"], cycles * cores);
    for (unsigned i = 0; i < cores; ++i)
      if (cores < 17 || i < 4 || i > cores - 5) core_line("core_" + std::to_string(i), s["core_" + std::to_string(i)], cycles);
    if (triangles)
      page.push_back(printed("%27s %5.1f%% of the cores' walking cycles issue a triangle", "fill", 100 * number(s["bih_core"]["fill"])));
    page.emplace_back();
    page.emplace_back("channels, share of all cycles:  transferred  starved  back-pressured   idle");
    for (const char* name : {"job", "pending_job", "result"}) {
      const json& c = s["channels"][name];
      page.push_back(printed("%30s %11.1f%% %7.1f%% %14.1f%% %5.1f%%", name, 100 * number(c["transferred"]) / cycles,
                             100 * number(c["starved"]) / cycles, 100 * number(c["back_pressured"]) / cycles,
                             100 * number(c["idle"]) / cycles));
    }
    page.emplace_back();
    const json& m = record["simulator"];
    page.push_back(printed("simulated in %.3f s (%s with everything: %.3f s): %.2f M rays/s, %.2f M cycles/s, %.2f edges a ray",
                           number(m["run_seconds"]), m["pace"].get<std::string>().c_str(), number(m["all_seconds"]),
                           rays / number(m["run_seconds"]) / 1e6, cycles / number(m["run_seconds"]) / 1e6, number(m["edges"]) / rays));
    CHECK(lines_of(o.out) == page);
    CHECK(number(m["ns_per_ray"]) == Approx(1e9 * number(m["run_seconds"]) / rays));
  }
}

TEST_CASE("summary: the simulator's own figures", "[summary]") {
  simulator_figures f;
  f.pace = "checked";
  f.followed = "turns";
  f.rays = 500;
  f.cycles = 4000;
  f.run_seconds = 2;
  f.all_seconds = 5;
  f.clock.edges = 1250;
  f.clock.unit_edges = 3000;
  f.clock.wake_ups = 17;
  config::report r;
  f.describe(r);
  CHECK(r.values() == json{{"version", program_version()},
                           {"pace", "checked"},
                           {"followed", "turns"},
                           {"run_seconds", 2.0},
                           {"all_seconds", 5.0},
                           {"rays_per_second", 250.0},
                           {"cycles_per_second", 2000.0},
                           {"ns_per_ray", 4e6},
                           {"edges", 1250},
                           {"unit_edges", 3000},
                           {"wake_ups", 17},
                           {"edges_per_ray", 2.5}});
}

}  // namespace rtusim
