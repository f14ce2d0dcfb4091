#include <catch2/catch.hpp>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/sweep_folder.h"

namespace rtusim {
namespace {

namespace fs = std::filesystem;
using Catch::Contains;
using namespace test;

TEST_CASE("sweep: every point has its row, in the order of the file, whatever the workers", "[testbench]") {
  const sweep_folder folder;
  const std::string lines = header + R"(
[set]
"svo_core.stack_depth" = 12
[[in_step]]
"frame.width" = [8, 16]
"frame.height" = [4, 9]
[axes]
"scheduler.policy" = ["round_robin", "first_available"]
"rtu.cores" = {from = 1, to = 8, factor = 2}
)";
  const outcome one = folder.sweep(lines, "one", {"-j", "1"});
  CHECK(one.status == 0);
  CHECK_THAT(one.out, Contains("16 points: 16 run now, 0 there before, in "));
  CHECK(folder.sweep(lines, "four", {"-j", "4", "--quiet"}).out.empty());
  check_same_tables(folder, "one", "four");
  const auto rows = rows_of(folder / "one/results.csv");
  REQUIRE(rows.size() == 16);
  std::size_t i = 0;
  for (const char* policy : {"round_robin", "first_available"})
    for (const char* cores : {"1", "2", "4", "8"})
      for (const auto& [width, height, rays] : {std::tuple{"8", "4", "32"}, {"16", "9", "144"}}) {
        const row& r = rows[i++];
        CHECK(r.at("scheduler.policy") == policy);
        CHECK(r.at("rtu.cores") == cores);
        CHECK(r.at("frame.width") == width);
        CHECK(r.at("frame.height") == height);
        CHECK(r.at("rays") == rays);
        CHECK(r.at("status") == "done");
      }
  const auto json = nlohmann::json::parse(bytes_of(folder / "one/results.json"));
  CHECK(json["points"].size() == 16);
  CHECK(json["points"][3]["axes"]["rtu.cores"] == 2);
  CHECK(json["columns"]["rays_per_second"]["unit"] == "1/s");
  CHECK(json["columns"]["rtu.cores"]["unit"] == "cores");
  CHECK(json["columns"]["channels.result.starved"]["unit"] == "cycles");
  // A point's figures are those of a run.
  const words run{"run",
                  "scene.toml",
                  "--stats",
                  "run.json",
                  "--quiet",
                  "--set",
                  "rtu.cores=4",
                  "--set",
                  "svo_core.stack_depth=12",
                  "--set",
                  "scheduler.policy=round_robin"};
  CHECK(rtusim(folder, run).status == 0);
  const std::string point = "one/points/" + rows[5].at("point") + "/stats.json";
  const outcome diff = rtusim(folder, {"diff", "run.json", point});
  CHECK(diff.status == 0);
  CHECK(diff.out == "no difference\n");
}

TEST_CASE("sweep: ranges with step and factor, whole and real, and what a constraint allows", "[testbench]") {
  const sweep_folder folder;
  const auto values = [&](const std::string& key, const std::string& range) {
    CHECK(folder.sweep(fmt::format("{}record = [\"rays\"]\n[axes]\n\"{}\" = {}\n", header, key, range)).err.empty());
    return fmt::format("{}", fmt::join(column(folder / "out/results.csv", key), " "));
  };
  CHECK(values("rtu.cores", "{from = 2, to = 9, step = 3}") == "2 5 8");
  CHECK(values("rtu.cores", "{from = 3, to = 5}") == "3 4 5");
  CHECK(values("rtu.cores", "{from = 1, to = 30, factor = 3}") == "1 3 9 27");
  CHECK(values("rtu.clock_mhz", "{from = 0.1, to = 0.3, step = 0.1}") == "0.1 0.2 0.3");
  CHECK(values("rtu.clock_mhz", "{from = 100, to = 400, factor = 1.5}") == "100 150 225 337.5");
  CHECK(values("camera.position", "[[-0.5, 0.35, -2.1], [1, 1e-3, 2.0]]") == "[ -0.5, 0.35, -2.1 ] [ 1, 0.001, 2 ]");

  const auto kept = [&](const std::string& constraint) {
    const outcome o = folder.sweep(header + "record = [\"rays\"]\nconstraints = [" + constraint +
                                   "]\n[axes]\n\"scheduler.policy\" = [\"round_robin\", \"first_available\"]\n\"rtu.cores\" = [1, 2, 4]\n");
    CHECK(o.err.empty());
    std::string points;
    for (const row& r : rows_of(folder / "out/results.csv")) points += r.at("scheduler.policy")[0] + r.at("rtu.cores") + ' ';
    CHECK_THAT(o.out, Contains(fmt::format("{} left out by constraints", 6 - points.size() / 3)));
    return points;
  };
  CHECK(kept("\"rtu.cores <= 2\"") == "r1 r2 f1 f2 ");
  CHECK(kept("'rtu.cores < 4 || is(\"scheduler.policy=round_robin\")'") == "r1 r2 r4 f1 f2 ");
  CHECK(kept("'is(\"scheduler.policy=first_available\")', \"rtu.cores * frame.width >= 32\"") == "f2 f4 ");
}

TEST_CASE("sweep: two scenes, two designs, and the pictures of each point", "[testbench]") {
  const sweep_folder folder;
  folder.file("small.toml", "[rtu]\ncores = 2\n");
  folder.file("large.toml", "[rtu]\ncores = 8\n");
  const std::string begin = "[sweep]\nscenes = [\"scene.toml\", \"other.toml\"]\narchitectures = [\"small.toml\", \"large.toml\"]\n";
  CHECK(folder.sweep(begin).status == 0);
  const auto before = times(folder);
  CHECK(before.size() == 4);
  CHECK(column(folder / "out/results.csv", "scene") == words{"scene.toml", "scene.toml", "other.toml", "other.toml"});
  CHECK(column(folder / "out/results.csv", "architecture") == words{"small.toml", "large.toml", "small.toml", "large.toml"});
  const auto sums = column(folder / "out/results.csv", "checksum");
  CHECK(std::set<std::string>(sums.begin(), sums.end()).size() == 4);

  // Pictures that were not asked for before are a reason to run a point again.
  CHECK_THAT(folder.sweep(begin + "images = [\"png\", \"depth.png\"]\n").out, Contains("4 run now, 0 there before"));
  for (const auto& [name, time] : before) {
    CHECK(bytes_of(folder / ("out/points/" + name + "/image.png")).substr(1, 3) == "PNG");
    CHECK(fs::file_size(folder / ("out/points/" + name + "/image.depth.png")) > 100);
  }
  CHECK_THAT(folder.sweep(begin + "images = [\"png\"]\n").out, Contains("0 run now, 4 there before"));
}

TEST_CASE("sweep: killed in its middle, it goes on with what is missing", "[testbench]") {
  const sweep_folder folder;
  const std::string lines = header + "[axes]\n\"rtu.cores\" = {from = 1, to = 60}\n";
  CHECK(folder.sweep(lines, "whole").status == 0);
  // Workers whose parent is killed become this process' children, so that it can wait for their end.
  REQUIRE(prctl(PR_SET_CHILD_SUBREAPER, 1) == 0);
  const auto done = [&] {
    std::error_code none;
    std::size_t points = 0;
    for (fs::directory_iterator at(folder / "out/points", none), end; !none && at != end; at.increment(none))
      points += at->path().filename().string()[0] != '.' ? 1 : 0;
    return points;
  };
  // On a busy machine it may come to its end before it is killed: then once more from the start.
  int status = 0;
  for (int attempt = 0; attempt < 10 && !WIFSIGNALED(status); ++attempt) {
    fs::remove_all(folder / "out");
    const pid_t child = test::start_rtusim(folder, {"sweep", "sweep.toml", "--out", "out", "--quiet", "-j", "2"}, stdout, stderr);
    pid_t ended = 0;
    while (ended == 0 && done() < 5) ended = waitpid(child, &status, WNOHANG);
    if (ended != 0) continue;
    REQUIRE(kill(child, SIGKILL) == 0);
    REQUIRE(waitpid(child, &status, 0) == child);
  }
  REQUIRE(WIFSIGNALED(status));
  while (waitpid(-1, nullptr, 0) > 0) continue;
  REQUIRE(errno == ECHILD);
  std::map<std::string, fs::file_time_type> before;
  for (const auto& entry : fs::directory_iterator(folder / "out/points"))
    if (entry.path().filename().string()[0] != '.')
      before[entry.path().filename().string()] = fs::last_write_time(entry.path() / "stats.json");
  const outcome again = folder.sweep(lines);
  CHECK_THAT(again.out, Contains(fmt::format("60 points: {} run now, {} there before", 60 - before.size(), before.size())));
  const auto after = times(folder);
  CHECK(after.size() == 60);
  for (const auto& [name, time] : before) CHECK(after.at(name) == time);
  check_same_tables(folder, "whole", "out");

  // A changed axis runs only what is new, and folders that went are run again.
  CHECK_THAT(folder.sweep(header + "[axes]\n\"rtu.cores\" = [3, 61, 5]\n").out, Contains("3 points: 1 run now, 2 there before"));
  fs::remove_all(folder / ("out/points/" + after.begin()->first));
  fs::remove(folder / ("out/points/" + std::next(after.begin())->first + "/stats.json"));
  CHECK_THAT(folder.sweep(lines).out, Contains("60 points: 2 run now, 58 there before"));
  check_same_tables(folder, "whole", "out");
}

TEST_CASE("sweep: a point that fails is a row with its reason", "[testbench]") {
  const sweep_folder folder;
  const auto reasons = [&](const std::string& lines) {
    const outcome o = folder.sweep(header + lines);
    CHECK(o.status == 1);
    CHECK_THAT(o.out, Contains(", 1 failed"));
    std::string all;
    for (const row& r : rows_of(folder / "out/results.csv")) {
      CHECK(r.at("status") == (r.at("reason").empty() ? "done" : "failed"));
      CHECK(r.at("rays").empty() != r.at("reason").empty());
      if (!r.at("reason").empty()) CHECK_THAT(o.err, Catch::StartsWith("rtusim: 1 point failed: " + r.at("reason") + "\n"));
      all += r.at("reason") + "|";
    }
    CHECK_THAT(o.err, Contains("\nrtusim: sweep: 1 of 2 points failed; "));
    return all;
  };
  CHECK(reasons("[axes]\n\"rtu.cores\" = [0, 1]\n") ==
        "--set: rtu.cores = 0; expected a whole number from 1 to 1024 cores|" + std::string("|"));
  CHECK_THAT(reasons("[axes]\n\"svo_core.stack_depth\" = [11, 2]\n"),
             Catch::StartsWith("|") && Contains("expected at most 3, for a stack of 2|"));
  CHECK_THAT(reasons("[set]\n\"watchdog.cycles\" = 1000\n[axes]\n\"sink.ready\" = [\"never\", \"always\"]\n"),
             Contains("no transfer in the 1000 cycles after cycle ") && Catch::EndsWith("||"));
  // It is tried again only if that is asked for, and only it; the rest is there.
  const std::string never = "[set]\n\"watchdog.cycles\" = 1000\n[axes]\n\"sink.ready\" = [\"never\", \"always\"]\n";
  CHECK_THAT(folder.sweep(header + never).out, Contains("2 points: 0 run now, 1 there before, 1 failed"));
  const std::string table = bytes_of(folder / "out/results.csv");
  const outcome retried = folder.sweep(header + never, "out", {"--retry-failed"});
  CHECK(retried.status == 1);
  CHECK_THAT(retried.out, Contains("2 points: 1 run now, 1 there before, 1 failed"));
  CHECK(bytes_of(folder / "out/results.csv") == table);
  CHECK_THAT(folder.sweep(header + "record = [\"hits\"]\n[axes]\n\"rtu.cores\" = [0]\n").out, Contains("1 failed"));

  // The reasons by their frequency, also where nothing else is told.
  const outcome many =
      folder.sweep(header + "[axes]\n\"svo_core.stack_depth\" = [2, 11]\n\"rtu.cores\" = [0, 1, 2, 2000]\n", "many", {"--quiet"});
  CHECK(many.status == 1);
  CHECK(many.out.empty());
  CHECK_THAT(many.err, Contains("rtusim: 2 points failed: --set: rtu.cores = 0; ") &&
                           Contains("rtusim: 2 points failed: --set: rtu.cores = 2000; ") && Contains("for a stack of 2\n") &&
                           Catch::EndsWith("sweep: 6 of 8 points failed; those that were run are run again with --retry-failed\n"));
}

TEST_CASE("sweep: a point that can't be written, memory that is too small, and a full disk", "[testbench]") {
  const sweep_folder folder;
  folder.file("sweep.toml", header + "record = [\"rays\"]\n[axes]\n\"rtu.cores\" = [1, 2]\n");
  test::limits tight;
  tight.most_bytes = 2000;
  tight.file_signal = true;
  const outcome died = rtusim(folder, {"sweep", "sweep.toml", "--out", "died"}, tight);
  CHECK(died.status == 2);
  CHECK_THAT(died.err, Contains("died: a result that could not be written (") && Contains("stats.json: File too large"));
  CHECK(times(folder, "died").empty());
  CHECK_THAT(rtusim(folder, {"sweep", "sweep.toml", "--out", "died"}).out, Contains("2 points: 2 run now, 0 there before, in"));

  const outcome full = rtusim(folder, {"sweep", "sweep.toml", "--out", "full"}, 1000);
  CHECK(full.status == 2);
  CHECK_THAT(full.err, Contains("File too large") || Contains("room on the disk"));
  CHECK(std::count(full.err.begin(), full.err.end(), '\n') == 1);
  CHECK(rtusim(folder, {"sweep", "sweep.toml", "--out", "full"}).status == 0);
  check_same_tables(folder, "died", "full");

#ifndef __SANITIZE_ADDRESS__  // which takes terabytes of addresses
  folder.file("sweep.toml", header + "[[in_step]]\n\"frame.width\" = [16384, 16]\n\"frame.height\" = [16384, 9]\n");
  test::limits little;
  little.most_memory = rlim_t{1} << 30;
  const outcome out = rtusim(folder, {"sweep", "sweep.toml", "--out", "large"}, little);
  CHECK_THAT(out.out, Contains("2 points: 2 run now, 0 there before, 1 failed"));
  CHECK(column(folder / "large/results.csv", "reason") == words{"out of memory", ""});
#endif
}

TEST_CASE("sweep: two machines' shares make one table", "[testbench]") {
  const sweep_folder folder;
  const std::string lines = header + "[axes]\n\"rtu.cores\" = [1, 2, 3, 4, 5]\n";
  CHECK(folder.sweep(lines, "whole").status == 0);
  const pid_t other = test::start_rtusim(folder, {"sweep", "sweep.toml", "--out", "out", "--share", "0/2"}, stdout, stderr);
  const outcome one = folder.sweep(lines, "out", {"--share", "1/2"});
  int status = -1;
  waitpid(other, &status, 0);
  CHECK(status == 0);
  CHECK(one.status == 0);
  CHECK(one.err.empty());
  CHECK_FALSE(fs::exists(folder / "out/results.csv"));
  CHECK_THAT(folder.sweep(lines).out, Contains("5 points: 0 run now, 5 there before"));
  check_same_tables(folder, "whole", "out");
}

TEST_CASE("sweep: triangle cores are replayed where that covers them, and run again to the byte", "[testbench]") {
  const sweep_folder folder;
  const std::string lines =
      "[sweep]\nscenes = [\"mesh.toml\"]\n[set]\n\"rtu.core\" = \"bih\"\n[axes]\n\"rtu.cores\" = [1, 4]\n"
      "\"t_div.kind\" = [\"pipelined\", \"iterative\"]\n";
  CHECK(folder.sweep(lines, "out", {"-j", "3"}).err.empty());
  CHECK(folder.sweep(lines, "one").status == 0);
  check_same_tables(folder, "out", "one");
  CHECK(column(folder / "out/results.csv", "reason") == words{"", "", "", ""});
  for (const std::string& point : column(folder / "out/results.csv", "point")) {
    const std::string stats = "out/points/" + point + "/stats.json";
    const auto record = nlohmann::json::parse(bytes_of(folder / stats));
    const bool covered = record["parameters"]["t_div"]["kind"] == "pipelined";
    CHECK(record["simulator"]["pace"] == (covered ? "replay" : "skipping"));
    CHECK(record["simulator"]["followed"] == (covered ? "jobs" : ""));
    const std::string beside = "out/points/" + point + "/again.json";
    const outcome again = rtusim(folder, {"rerun", stats, "--stats", beside});
    CHECK(again.status == 0);
    CHECK_THAT(again.out, Catch::StartsWith("the same figures again: "));
    CHECK(bytes_of(folder / stats) == bytes_of(folder / beside));
  }
}

TEST_CASE("rerun: the same bytes again, and no other model's", "[testbench]") {
  const sweep_folder folder;
  fs::copy_file(models + "dragon_8.svo", folder / "copy.svo");
  const words run{"run",     "--model", "copy.svo", "--set",       "frame.width=16", "--set", "frame.height=9",
                  "--quiet", "--stats", "old.json", "--save-jobs", "jobs.bin"};
  const auto with = [&](const words& more) {
    words all = run;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  for (const char* pace : {"skipping", "replay"}) {
    CHECK(rtusim(folder, with({"--pace", pace})).status == 0);
    CHECK(rtusim(folder, {"rerun", "old.json", "--stats", "new.json", "--quiet"}).out.empty());
    CHECK(bytes_of(folder / "old.json") == bytes_of(folder / "new.json"));
  }
  CHECK(rtusim(folder, {"run", "--model", "copy.svo", "--jobs", "jobs.bin", "--stats", "jobs.json", "--quiet"}).status == 0);
  CHECK(rtusim(folder, {"rerun", "jobs.json"}).status == 0);

  const std::string text = bytes_of(folder / "old.json");
  const auto changed = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    folder.file("changed.json", text.substr(0, at) + to + text.substr(at + from.size()));
    return rtusim(folder, {"rerun", "changed.json", "--stats", "never.json"});
  };
  const outcome figure = changed("\"hits\": ", "\"hits\": 1");
  CHECK(figure.status == 1);
  CHECK_THAT(figure.out, Contains("statistics\n  hits "));
  CHECK_THAT(figure.err, Contains("changed.json: run again, figures differ"));
  fs::remove(folder / "never.json");
  const std::tuple<const char*, const char*, const char*> refused[] = {
      {"\"rtusim statistics\"", "\"statistics\"", "changed.json: no statistics file"},
      {"\"version\": ", "\"version\": 9", "changed.json: version 9"},
      {"\"inputs\": {", "\"inputs\": 3, \"x\": {", "changed.json: no object inputs"},
      {"\"model_crc32\": \"", "\"model_crc32\": \"0", "inputs.model_crc32 = 0"},
      {"\"jobs_crc32\": \"", "\"jobs_crc32\": 7, \"x\": \"", "changed.json: no text inputs.jobs_crc32"},
      {"\"cores\": 16", "\"cores\": 0", "changed.json: rtu.cores = 0"},
      {"\"cores\": 16", "\"coress\": 16", "unknown key rtu.coress; expected rtu.cores"},
      {"\"pace\": \"", "\"pace\": 3, \"x\": \"", "changed.json: no text simulator.pace"},
      {"{", "", "changed.json: no statistics file"},
  };
  for (const auto& [from, to, expected] : refused) {
    const outcome o = changed(from, to);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, Contains(expected));
    CHECK_FALSE(fs::exists(folder / "never.json"));
  }
  CHECK_THAT(rtusim(folder, {"rerun", "none.json"}).err, Contains("none.json: no such file"));
  fs::copy_file(models + "dragon_32s.svo", folder / "copy.svo", fs::copy_options::overwrite_existing);
  const outcome other = rtusim(folder, {"rerun", "old.json"});
  CHECK(other.status == 2);
  CHECK_THAT(other.err, Contains("old.json: inputs.model_crc32 = ") && Contains("of what lies there now"));
}

TEST_CASE("Records name files from their own folder, and are found from everywhere", "[testbench]") {
  const sweep_folder folder;
  for (const char* sub : {"a", "b", "b/c"}) fs::create_directories(folder / sub);
  fs::copy_file(models + "dragon_8.svo", folder / "a/model.svo");
  folder.file("a/scene.toml", "[scene]\nmodel = \"model.svo\"\n[frame]\nwidth = 16\nheight = 9\n");
  const auto run = [&](const std::string& from, const std::string& scene, const std::string& stats) {
    words w{"run", scene, "--stats", stats, "--pace", "replay", "--quiet"};
    CHECK(test::rtusim(folder / from, w).status == 0);
  };
  const auto inputs = [&](const char* file) { return nlohmann::json::parse(bytes_of(folder / file))["inputs"]; };
  run("", "a/scene.toml", "b/here.json");
  run("b/c", "../../a/scene.toml", "../there.json");
  CHECK(inputs("b/here.json") == inputs("b/there.json"));
  CHECK(inputs("b/here.json")["scene"] == "../a/scene.toml");
  CHECK(inputs("b/here.json")["model"] == "../a/model.svo");
  CHECK(nlohmann::json::parse(bytes_of(folder / "b/here.json"))["parameters"]["scene"]["model"] == "../a/model.svo");
  run("", "a/scene.toml", "b/c/deeper.json");
  CHECK(inputs("b/c/deeper.json")["model"] == "../../a/model.svo");
  CHECK(rtusim(folder, {"diff", "b/here.json", "b/c/deeper.json"}).out == "no difference\n");
  fs::copy_file(folder / "a/model.svo", folder / "b/model.svo");
  folder.file("b/scene.toml", bytes_of(folder / "a/scene.toml"));
  run("b", "scene.toml", "other.json");
  CHECK_THAT(rtusim(folder, {"diff", "b/here.json", "b/other.json"}).out, Contains("  model ") && Contains("/a/model.svo"));

  // Run again from another folder, into the same one and into another.
  CHECK(test::rtusim(folder / "a", {"rerun", "../b/here.json", "--stats", "../b/again.json", "--quiet"}).status == 0);
  CHECK(bytes_of(folder / "b/again.json") == bytes_of(folder / "b/here.json"));
  CHECK(rtusim(folder, {"rerun", "b/here.json", "--stats", "moved.json"}).status == 0);
  CHECK(inputs("moved.json")["model"] == "a/model.svo");
  CHECK(test::rtusim(folder / "b", {"rerun", "../moved.json"}).status == 0);
  fs::create_symlink("b/here.json", folder / "link.json");
  CHECK(rtusim(folder, {"rerun", "link.json"}).status == 0);
}

TEST_CASE("diff: what differs in design and in result", "[testbench]") {
  const sweep_folder folder;
  const auto run = [&](const char* cores, const std::string& to) {
    CHECK(rtusim(folder, {"run", "scene.toml", "--set", std::string("rtu.cores=") + cores, "--stats", to, "--quiet"}).status == 0);
  };
  run("1", "a.json");
  run("2", "b.json");
  run("1", "c.json");
  CHECK(rtusim(folder, {"diff", "a.json", "c.json"}).out == "no difference\n");
  const outcome o = rtusim(folder, {"diff", "a.json", "b.json"});
  CHECK(o.status == 0);
  CHECK_THAT(o.out, Contains("parameters\n  rtu.cores ") && Contains("+100.00 %") && Contains("statistics\n  total_cycles ") &&
                        Contains("  core_1.jobs ") && !Contains("inputs") && !Contains("simulator"));
  folder.file("text.json", "{\"format\": 3}");
  CHECK_THAT(rtusim(folder, {"diff", "a.json", "text.json"}).err, Contains("text.json: no statistics file"));
  // As deep as only a file that is meant to break its reader.
  std::string deep = bytes_of(folder / "a.json");
  const std::size_t at = deep.find("\"parameters\": ") + 14;
  deep.insert(at, std::string(100'000, '[') + std::string(100'000, ']') + ',');
  folder.file("deep.json", deep);
  CHECK_THAT(rtusim(folder, {"diff", "a.json", "deep.json"}).err, Contains("deep.json: no statistics file"));
  CHECK_THAT(rtusim(folder, {"rerun", "deep.json"}).err, Contains("deep.json: no statistics file"));
  CHECK_THAT(rtusim(folder, {"diff", "a.json"}).err, Contains("diff: B.json is required"));
}

TEST_CASE("sweep: a file, a folder or an option that can't be used is refused in one line", "[testbench]") {
  const sweep_folder folder;
  fs::create_directories(folder / "foreign");
  folder.file("foreign/letter", "");
  for (const auto& [name, mark] : {std::pair{"version", "{\"format\": \"rtusim sweep\", \"version\": 9}"},
                                   {"text", "{\"format\": 3}"},
                                   {"word", "{\"format\": \"rtusim sweep\", \"version\": \"1\"}"},
                                   {"garbage",
                                    "\x7f"
                                    "ELF"}}) {
    fs::create_directories(folder / name);
    folder.file(std::string(name) + "/sweep.json", mark);
  }
  struct bad {
    std::string lines, text;
    words also = {};
  };
  const std::string cores = header + "[axes]\n\"rtu.cores\" = [1]\n";
  const auto axis = [](const std::string& line) { return header + "[axes]\n" + line + "\n"; };
  std::string thousands = header + "[axes]\n";
  for (const char* key : {"rtu.cores", "frame.width", "frame.height"}) thousands += fmt::format("\"{}\" = {{from = 1, to = 1000}}\n", key);
  const bad all[] = {
      {"", "sweep.toml: no sweep.scenes"},
      {"[sweep]\nscenes = [", "sweep.toml:2"},
      {"\x7f"
       "ELF\x02 = [",
       "sweep.toml:1"},
      {"[sweep]\nscenes = []\n", "sweep.toml:2: scenes = []; expected at least one"},
      {"[sweep]\nscenes = [\"scen.toml\"]\n", "scen.toml, which is no file"},
      {"[sweep]\nscenes = [3]\n", "sweep.toml:2: scenes with what is no text"},
      {"[sweeps]\n", "sweep.toml:1: unknown section sweeps"},
      {header + "colour = 3\n", "sweep.toml:3: unknown key sweep.colour"},
      {header + "limit = 0\n", "sweep.toml:3: limit that is no such number"},
      {header + "images = [\"cots.png\"]\n", "unknown kind of picture \"cots\""},
      {header + "record = [\"rays_per_secnd\"]\n", "sweep.toml:3: no figure rays_per_secnd; expected rays_per_second"},
      {header + "record = [\"rays\", \"wait\"]\n", "sweep.toml:3: no figure wait; expected waits"},
      {header + "record = [\"channel." + std::string(300'000, 'a') + "\"]\n", "no figure channel.aaaaaaaa"},
      {header + "record = [\"channels." + std::string(300'000, 'a') + "\"]\n", "sweep.record: channels.aaaaaaaa"},
      {header + "record = [\"channels.jbo\"]\n", "sweep.record: channels.jbo, which no point has"},
      {header + "constraints = [\"rtu.coress > 3\"]\n", "sweep.toml:3: \"rtu.coress > 3\": "},
      {header + "constraints = [\"rtu.cores >\"]\n", "sweep.toml:3: \"rtu.cores >\": "},
      {header + "constraints = ['is(\"policy\")']\n", "sweep.toml:3: is(\"policy\"); expected is(\"KEY=WORD\")"},
      {header + "constraints = [\"rtu.cores > 100\"]\n", "no point that the constraints allow"},
      {axis("\"rtu.cores\" = []"), "sweep.toml:4: rtu.cores = []; expected at least one value"},
      {axis("rtu.cores = 3"), "sweep.toml:4: rtu.cores without a list"},
      {axis("\"rtu.coress\" = [1]"), "sweep.toml:4: unknown key rtu.coress; expected rtu.cores"},
      {axis("\"rtu\" = [1]"), "sweep.toml:4: unknown key rtu"},
      {axis("\"rtu.cores\" = {from = 1}"), "sweep.toml:4: rtu.cores with a range that is none"},
      {axis("\"rtu.cores\" = {from = 1, to = 9, stride = 2}"), "sweep.toml:4: rtu.cores with a range that has stride; expected from, to,"},
      {axis("\"rtu.cores\" = {from = 1, to = 9, step = 0}"), "sweep.toml:4: rtu.cores with a range that never ends"},
      {axis("\"rtu.cores\" = {from = 1, to = 9, factor = 1}"), "sweep.toml:4: rtu.cores with a range that never ends"},
      {axis("\"rtu.cores\" = {from = 9, to = 1}"), "sweep.toml:4: rtu.cores with a range that never ends"},
      {axis("\"rtu.cores\" = {from = 1, to = inf}"), "rtu.cores: to that is no number"},
      {axis("\"rtu.cores\" = {from = 1, to = 1000000000}"), "sweep.toml:4: rtu.cores with 999999999 values; expected at most 1000000"},
      {thousands, "sweep.toml: 1000000000 points; expected at most sweep.limit = 10000: set that if so many are meant"},
      {cores + "[[in_step]]\n\"rtu.cores\" = [2]\n", "sweep.toml:5: a second axis rtu.cores; expected each key once"},
      {axis("\"rtu.cores\" = [1]\n\"rtu.cores\" = [2]"), "sweep.toml:5"},
      {header + "[[in_step]]\n\"frame.width\" = [1, 2]\n\"frame.height\" = [1]\n",
       "sweep.toml:5: 1 values of frame.height; expected 2, as of frame.width"},
      {header + "[in_step]\n", "sweep.toml:3: in_step that is no array of tables"},
      {header + "[set]\n\"rtu.coress\" = 1\n", "sweep.toml:4: unknown key rtu.coress; expected rtu.cores"},
      {header + "[set]\n\"rtu.cores\" = [1]\n", "sweep.toml:4: rtu.cores with what is no value"},
      {cores, "-j: \"0\"; expected a whole number from 1 to 4096", {"-j", "0"}},
      {cores, "-j: \"two\"", {"-j", "two"}},
      {cores, "--share: \"2/2\"; expected I/N with I from 0 to N - 1", {"--share", "2/2"}},
      {cores, "--share: \"half\"", {"--share", "half"}},
      {cores, "--engine: \"cloud\"; expected local or slurm", {"--engine", "cloud"}},
      {cores, "foreign: a folder that holds something else", {"--out", "foreign"}},
      {cores, "scene.toml: ", {"--out", "scene.toml"}},
      {cores, "version/sweep.json: results of version 9", {"--out", "version"}},
      {cores, "word/sweep.json: results of version \"1\"", {"--out", "word"}},
      {cores, "text/sweep.json: no mark of a sweep's results", {"--out", "text"}},
      {cores, "garbage/sweep.json: no mark of a sweep's results", {"--out", "garbage"}},
  };
  for (const bad& b : all) {
    INFO(b.lines << fmt::format("{}", fmt::join(b.also, " ")));
    folder.file("sweep.toml", b.lines);
    words arguments{"sweep", "sweep.toml", "--quiet"};
    arguments.insert(arguments.end(), b.also.begin(), b.also.end());
    const outcome o = rtusim(folder, arguments);
    CHECK(o.status == 2);
    CHECK(o.out.empty());
    CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
    CHECK_THAT(o.err, Catch::StartsWith("rtusim: ") && Contains(b.text));
  }
  CHECK_THAT(rtusim(folder, {"sweep", "none.toml"}).err, Contains("none.toml: no such file"));
  CHECK_THAT(rtusim(folder, {"sweep"}).err, Contains("SWEEP.toml is required"));

  folder.file("sweep.toml", cores);
  test::limits nowhere;
  nowhere.path = "/nonexistent";
  const outcome slurm = rtusim(folder, {"sweep", "sweep.toml", "--engine", "slurm", "--out", "slurm"}, nowhere);
  CHECK(slurm.status == 2);
  CHECK_THAT(slurm.err, Contains("--engine slurm: no sbatch on PATH; expected Slurm, or slurm/slurm.sh submitted where there is one"));
}

}  // namespace
}  // namespace rtusim
