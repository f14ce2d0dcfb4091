#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/files.h"
#include "testbench/bench/host_figures.h"
#include "testbench/run/job_file.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
using test::bytes_of;
using test::outcome;
using test::rtusim;
using test::words;

const std::string source = RTUSIM_SOURCE_DIR "/";
const std::string dragon = source + "testbench/golden/svo/models/dragon_32.svo";
const words voxels{"run", "--quiet", "--model", dragon, "--set", "frame.width=32", "--set", "frame.height=18"};
const words triangles{"run",     "--quiet",
                      "--arch",  source + "testbench/architectures/hanika2007.toml",
                      "--model", source + "scenes/data/teapot.bpt",
                      "--set",   "frame.width=32",
                      "--set",   "frame.height=18"};

/// The record of a run, which `also` changes, and what it says on the terminal.
struct recorded {
  json statistics, parameters;
  std::string told;
};

recorded record_of(const test::scratch_folder& folder, words command, const words& also) {
  command.insert(command.end(), also.begin(), also.end());
  command.insert(command.end(), {"--stats", "stats.json"});
  const outcome o = rtusim(folder, command);
  INFO(o.err);
  REQUIRE(o.status == 0);
  const json all = json::parse(bytes_of(folder / "stats.json"));
  return {all["statistics"], all["parameters"], o.err};
}

std::uint64_t sum_of(const json& cycles) {
  std::uint64_t sum = 0;
  for (const auto& c : cycles) sum += c.get<std::uint64_t>();
  return sum;
}

}  // namespace

TEST_CASE("host figures: jobs with the id of an earlier one", "[testbench]") {
  const auto jobs_of = [](std::initializer_list<std::uint32_t> words) {
    std::vector<job_packet> jobs;
    for (const std::uint32_t w : words) jobs.push_back({w, {}, {}, 0});
    return jobs;
  };
  CHECK(duplicate_ids({}) == 0);
  CHECK(duplicate_ids(jobs_of({3, 1, 2, 0})) == 0);
  CHECK(duplicate_ids(jobs_of({3, 1, 3, 3, 0, 1})) == 3);
  CHECK(duplicate_ids(jobs_of({5, 5 | 3u << job_id_bits, job_id_mask, job_id_mask})) == 2);
}

TEST_CASE("host figures: the nearest of several results for a pixel is shown, whatever their order", "[testbench]") {
  const test::scratch_folder folder;
  const recorded near = record_of(folder, voxels, {"--save-jobs", "near.bin", "--image", "near.png"});
  const recorded away = record_of(folder, voxels,
                                  {"--save-jobs", "away.bin", "--set", "camera.kind=look_at", "--set", "camera.position=[3, 0, 0]", "--set",
                                   "camera.target=[9, 0, 0]"});
  CHECK(near.statistics["hits"] > 50);
  CHECK(away.statistics["hits"] == 0);
  for (const auto& [first, second] :
       {std::pair{"near.bin", "away.bin"}, std::pair{"away.bin", "near.bin"}, std::pair{"near.bin", "near.bin"}}) {
    CAPTURE(first, second);
    folder.file("both.bin", bytes_of(folder / first) + bytes_of(folder / second));
    const recorded both = record_of(folder, voxels, {"--jobs", "both.bin", "--image", "both.png", "--log", "both.csv"});
    CHECK(bytes_of(folder / "both.png") == bytes_of(folder / "near.png"));
    CHECK(both.statistics["host"]["duplicate_ids"] == 32 * 18);
    CHECK(both.told == "rtusim: warning: 576 jobs have the id of an earlier one; a picture shows the nearest hit\n");
    const std::string log = bytes_of(folder / "both.csv");
    CHECK(std::count(log.begin(), log.end(), '\n') == 1 + 2 * 32 * 18);
  }
  CHECK(near.statistics["host"]["duplicate_ids"] == 0);
  CHECK(near.told.empty());
}

TEST_CASE("host figures: rays that are not sent, and directions that are changed", "[testbench]") {
  const test::scratch_folder folder;
  const recorded some = record_of(folder, triangles, {});
  CHECK(some.statistics["host"]["unsent_rays"] == 32 * 18 - some.statistics["rays"].get<int>());
  CHECK(some.statistics["host"]["unsent_rays"] > 0);
  const recorded all = record_of(folder, triangles, {"--set", "driver.skip_misses=false"});
  CHECK(all.statistics["host"]["unsent_rays"] == 0);
  CHECK(all.statistics["rays"] == 32 * 18);
  CHECK(all.statistics["hits"] == some.statistics["hits"]);

  // From 3 in z straight down on the middle: two components of each ray are 0.
  folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n0.1,0.1,3,0,0,-1\n0.2,0.1,3,0,0,-2\n0.1,0.1,3,0.2,0.3,-1\n");
  folder.file("scene.toml", "[scene]\nmodel = \"" + dragon + "\"\nrays = \"rays.csv\"\n");
  const recorded straight = record_of(folder, {"run", "--quiet", "scene.toml"}, {});
  CHECK(straight.statistics["host"]["replaced_components"] == 4);
  CHECK_FALSE(straight.statistics["host"].contains("triangles"));
}

TEST_CASE("host figures: triangles that are clamped, and the edge shift that clamps none", "[testbench]") {
  const test::scratch_folder folder;
  const recorded chosen =
      record_of(folder, triangles, {"--set", "quantisation.m=20", "--set", "quantisation.edge_shift=auto", "--log", "chosen.csv"});
  const json& host = chosen.statistics["host"]["triangles"];
  const auto shift = host["edge_shift"].get<unsigned>();
  CHECK(host["clamped"] == 0);
  CHECK(chosen.parameters["quantisation"]["edge_shift"] == "auto");
  CHECK(chosen.told.empty());
  REQUIRE(shift < 20);

  const recorded given = record_of(
      folder, triangles, {"--set", "quantisation.m=20", "--set", fmt::format("quantisation.edge_shift={}", shift), "--log", "given.csv"});
  CHECK(given.statistics["host"]["triangles"] == host);
  CHECK(given.statistics["checksum"] == chosen.statistics["checksum"]);
  CHECK(bytes_of(folder / "given.csv") == bytes_of(folder / "chosen.csv"));
  const recorded beyond =
      record_of(folder, triangles, {"--set", "quantisation.m=20", "--set", fmt::format("quantisation.edge_shift={}", shift + 1)});
  CHECK(beyond.statistics["host"]["triangles"]["clamped"] > 0);
  CHECK_THAT(beyond.told, Catch::Contains("have edges beyond edge_shift and were clamped\n"));

  // The same from its record, with the word in it.
  record_of(folder, triangles, {"--set", "quantisation.m=20", "--set", "quantisation.edge_shift=auto"});
  CHECK(rtusim(folder, {"rerun", "stats.json", "--quiet"}).status == 0);
}

TEST_CASE("host figures: there is one count of cycles", "[testbench]") {
  const test::scratch_folder folder;
  for (const auto& [command, core] : {std::pair{voxels, "svo_core"}, std::pair{triangles, "bih_core"}}) {
    const json s = record_of(folder, command, {"--set", "rtu.cores=3", "--log", "log.csv"}).statistics;
    const auto total = s["total_cycles"].get<std::uint64_t>();
    CAPTURE(core);
    CHECK(s["last_result_cycle"] == total - 1);
    const std::string log = bytes_of(folder / "log.csv");
    const std::size_t last = log.rfind('\n', log.size() - 2) + 1;
    CHECK(log.substr(last, log.find(',', last) - last) == std::to_string(total - 1));
    CHECK(sum_of(s[core]["cycles"]) == 3 * total);
    for (const char* one : {"core_0", "core_1", "core_2"}) CHECK(sum_of(s[one]["cycles"]) == total);
    for (const auto& [name, counts] : s["channels"].items()) {
      CAPTURE(name);
      CHECK(sum_of(counts) == total);
    }
    CHECK(s["cycles_per_ray"].get<double>() == Approx(static_cast<double>(total) / s["rays"].get<double>()));
    const outcome loud = rtusim(folder, [&, all = command]() mutable {
      all.erase(all.begin() + 1);
      all.insert(all.end(), {"--set", "rtu.cores=3"});
      return all;
    }());
    CHECK_THAT(loud.out, Catch::Contains(fmt::format("{:>14} cycles   {} rays", total, s["rays"].get<std::uint64_t>())));
  }
}

}  // namespace rtusim
