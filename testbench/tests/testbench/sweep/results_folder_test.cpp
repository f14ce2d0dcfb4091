#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/input_ledger.h"
#include "modules/config/temporary.h"
#include "testbench/sweep/sweep_identity.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/sweep_folder.h"

namespace rtusim {
namespace {

namespace fs = std::filesystem;
using Catch::Contains;
using namespace test;

const std::string five = header + "[axes]\n\"rtu.cores\" = [1, 2, 3, 4, 5]\n";

/// A folder whose sweep needs nothing from outside.
fs::path lay_out(const scratch_folder& in, const std::string& name, const std::string& model) {
  const fs::path home = in / name;
  fs::create_directories(home);
  fs::copy_file(models + model + ".svo", home / "model.svo", fs::copy_options::overwrite_existing);
  std::ofstream(home / "scene.toml") << "[scene]\nmodel = \"model.svo\"\n[frame]\nwidth = 16\nheight = 9\n";
  std::ofstream(home / "sweep.toml") << five;
  return home;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_so_far(std::FILE* file) {
  std::fflush(file);
  return bytes_of(fmt::format("/proc/self/fd/{}", fileno(file)));
}

TEST_CASE("sweep: from another folder nothing is run again, and the bytes are the same", "[testbench]") {
  const scratch_folder folder;
  const fs::path a = lay_out(folder, "a", "dragon_32"), b = lay_out(folder, "b", "dragon_32");
  fs::create_directories(folder / "else/where");
  CHECK(rtusim(a, {"sweep", "sweep.toml", "--out", "out"}).status == 0);
  const std::string csv = bytes_of(a / "out/results.csv"), json = bytes_of(a / "out/results.json");
  CHECK_THAT(rtusim(folder / "else/where", {"sweep", "../../a/sweep.toml", "--out", "../../a/out"}).out,
             Contains("5 points: 0 run now, 5 there before"));
  CHECK_THAT(rtusim(folder / "else/where", {"sweep", (a / "sweep.toml").string(), "--out", (a / "out").string()}).out,
             Contains("0 run now"));
  CHECK(bytes_of(a / "out/results.csv") == csv);
  CHECK(bytes_of(a / "out/results.json") == json);
  // A copy of it all goes on with the results of the first.
  CHECK_THAT(rtusim(b, {"sweep", "sweep.toml", "--out", "../a/out"}).out, Contains("0 run now"));
  CHECK(rtusim(folder / "else", {"sweep", "../b/sweep.toml", "--out", "../b/out"}).status == 0);
  CHECK(bytes_of(b / "out/results.csv") == csv);
  const std::string point = names_in(a / "out/points").front();
  const auto inputs = [&](const fs::path& home) {
    return nlohmann::json::parse(bytes_of(home / "out/points" / point / "stats.json"))["inputs"];
  };
  CHECK(inputs(a) == inputs(b));
  CHECK(inputs(a)["model"] == "../../../model.svo");
  CHECK(rtusim(folder / "else", {"rerun", (a / "out/points" / point / "stats.json").string()}).status == 0);

  // Another model under the same name is another scene.
  lay_out(folder, "b", "dragon_8");
  CHECK_THAT(rtusim(b, {"sweep", "sweep.toml", "--out", "../a/out"}).out, Contains("5 points: 5 run now, 0 there before"));
  CHECK(bytes_of(a / "out/results.csv") != csv);
  CHECK_THAT(rtusim(a, {"sweep", "sweep.toml", "--out", "out"}).out, Contains("5 points: 0 run now, 5 there before"));
  CHECK(bytes_of(a / "out/results.csv") == csv);

  // And so is what another program ran.
  for (const char* member : {"program", "meaning"}) {
    const fs::path file = a / "out/points" / point / "identity.json";
    auto identity = nlohmann::ordered_json::parse(bytes_of(file));
    identity[member] = 0;
    std::ofstream(file) << identity.dump() << '\n';
    CHECK_THAT(rtusim(a, {"sweep", "sweep.toml", "--out", "out"}).out, Contains("5 points: 1 run now, 4 there before"));
  }
  CHECK(bytes_of(a / "out/results.csv") == csv);
}

TEST_CASE("sweep: a buffer of a mesh is a part of it", "[testbench]") {
  const scratch_folder folder;
  const auto buffer = [&](float x) {
    const std::array<float, 12> corners{0, 0, 0, x, 0, 0, 0, 1, 0, 0, 0, 1};
    const std::array<std::uint16_t, 12> faces{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    std::ofstream out(folder / "mesh.bin", std::ios::binary);
    out.write(reinterpret_cast<const char*>(corners.data()), sizeof corners);
    out.write(reinterpret_cast<const char*>(faces.data()), sizeof faces);
  };
  buffer(1);
  folder.file("mesh.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "buffers": [{"byteLength": 72, "uri": "mesh.bin"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]})");
  folder.file("scene.toml", "[scene]\nmodel = \"mesh.gltf\"\nresolution = 16\n[frame]\nwidth = 16\nheight = 9\n");
  folder.file("sweep.toml", header + "[axes]\n\"rtu.cores\" = [1, 2]\n");
  const words sweep{"sweep", "sweep.toml", "--out", "out"};
  const outcome first = rtusim(folder, sweep);
  CHECK(first.err.empty());
  CHECK_THAT(first.out, Contains("2 points: 2 run now"));
  CHECK_THAT(rtusim(folder, sweep).out, Contains("2 points: 0 run now"));
  buffer(0.25F);
  CHECK_THAT(rtusim(folder, sweep).out, Contains("2 points: 2 run now"));
}

TEST_CASE("sweep: files that are replaced while it runs change none of its rows", "[testbench]") {
  const scratch_folder folder;
  const auto write_scenes = [&](const char* model, int width) {
    for (const char* name : {"first", "second"}) {
      fs::copy_file(models + model + ".svo", folder / (std::string(name) + ".new"), fs::copy_options::overwrite_existing);
      fs::rename(folder / (std::string(name) + ".new"), folder / (std::string(name) + ".svo"));
      folder.file(std::string(name) + ".toml", fmt::format("[scene]\nmodel = \"{}.svo\"\n[frame]\nwidth = {}\nheight = 9\n", name, width));
    }
    folder.file("design.toml", fmt::format("[svo_core]\nstack_depth = {}\n", width));
  };
  const std::string lines =
      "[sweep]\nscenes = [\"first.toml\", \"second.toml\"]\narchitectures = [\"design.toml\"]\n"
      "[axes]\n\"rtu.cores\" = {from = 1, to = 40}\n";
  folder.file("sweep.toml", lines);
  write_scenes("dragon_32", 16);
  const words quietly{"sweep", "sweep.toml", "--quiet", "--out"};
  const auto into = [&](const char* out) {
    words w = quietly;
    w.emplace_back(out);
    return w;
  };
  CHECK(rtusim(folder, into("whole")).status == 0);
  const pid_t child = start_rtusim(folder, into("out"), stdout, stderr);
  const auto has_begun = [&] {
    std::error_code none;
    for (fs::directory_iterator at(folder / "out/points", none), end; !none && at != end; at.increment(none))
      if (at->path().filename().string()[0] != '.') return true;
    return false;
  };
  int status = 0;
  while (!has_begun() && waitpid(child, &status, WNOHANG) == 0) continue;
  write_scenes("dragon_8", 20);
  folder.file("sweep.toml", header);
  waitpid(child, &status, 0);
  CHECK(status == 0);
  check_same_tables(folder, "whole", "out");
  for (const row& r : rows_of(folder / "out/results.csv")) {
    const auto record = nlohmann::json::parse(bytes_of(folder / ("out/points/" + r.at("point") + "/stats.json")));
    CHECK(record["inputs"]["model_words"] == 685);
    CHECK(record["parameters"]["frame"]["width"] == 16);
    CHECK(record["parameters"]["svo_core"]["stack_depth"] == 16);
    CHECK(record["statistics"]["rays"] == 144);
  }
  folder.file("sweep.toml", lines);
  CHECK_THAT(rtusim(folder, {"sweep", "sweep.toml", "--out", "out"}).out, Contains("80 points: 80 run now, 0 there before"));
}

TEST_CASE("What a run read is held against what its identity holds") {
  const auto file = [](const char* name, const char* bytes) { return config::input_file{name, name, 1, config::sha256_of(bytes)}; };
  const std::vector<config::input_file> mesh{file("m.gltf", "1"), file("m.bin", "2")};
  CHECK(changed_input(mesh, mesh, true).empty());
  CHECK(changed_input(mesh, {file("m.gltf", "1"), file("m.bin", "3")}, true) == "m.bin");
  CHECK(changed_input(mesh, {file("m.gltf", "3")}, false) == "m.gltf");
  CHECK(changed_input(mesh, {file("m.gltf", "1")}, false).empty());  // it failed before it came to the rest
  CHECK(changed_input(mesh, {file("m.gltf", "1")}, true) == "m.bin");
  CHECK(changed_input({mesh[0]}, mesh, true) == "m.bin");
}

TEST_CASE("sweep: a second one in the same folder waits, shares do not wait for each other", "[testbench]") {
  const sweep_folder folder;
  CHECK(folder.sweep(five).status == 0);
  const std::string csv = bytes_of(folder / "out/results.csv");
  fs::remove_all(folder / "out/points");
  const int lock = open((folder / "out/lock").c_str(), O_RDWR | O_CLOEXEC);
  REQUIRE(lock >= 0);
  for (const int kind : {LOCK_SH, LOCK_EX}) {
    REQUIRE(flock(lock, kind) == 0);
    using stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
    const stream err(std::tmpfile(), &std::fclose), out(std::tmpfile(), &std::fclose);
    if (kind == LOCK_SH) CHECK(rtusim(folder, {"sweep", "sweep.toml", "--out", "out", "--share", "0/2"}).status == 0);
    const pid_t child = start_rtusim(folder, {"sweep", "sweep.toml", "--out", "out"}, out.get(), err.get());
    int status = 0;
    while (text_so_far(err.get()).empty() && waitpid(child, &status, WNOHANG) == 0) continue;
    CHECK(text_so_far(err.get()) == "rtusim: waiting for another sweep in out to end\n");
    CHECK(waitpid(child, &status, WNOHANG) == 0);
    CHECK(names_in(folder / "out/points").size() == (kind == LOCK_SH ? 3 : 5));
    REQUIRE(flock(lock, LOCK_UN) == 0);
    waitpid(child, &status, 0);
    CHECK(status == 0);
    CHECK(bytes_of(folder / "out/results.csv") == csv);
  }
  // And one that waits can be interrupted.
  REQUIRE(flock(lock, LOCK_EX) == 0);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> err(std::tmpfile(), &std::fclose);
  const pid_t child = start_rtusim(folder, {"sweep", "sweep.toml", "--out", "out"}, stdout, err.get());
  int status = 0;
  while (text_so_far(err.get()).empty() && waitpid(child, &status, WNOHANG) == 0) continue;
  kill(child, SIGTERM);
  waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 1);
  CHECK_THAT(text_so_far(err.get()), Contains("rtusim: sweep: interrupted while it waited for another sweep in out\n"));
  close(lock);
}

TEST_CASE("sweep: at its start the parts of processes that are no more go, and only those", "[testbench]") {
  const sweep_folder folder;
  CHECK(folder.sweep(five).status == 0);
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  REQUIRE(waitpid(dead, nullptr, 0) == dead);
  const std::string live = config::process_mark(), here = live.substr(0, live.find('-'));
  const std::string stay[] = {
      fmt::format(".part-{}-0123456789abcdef", live),
      fmt::format(".part-{}-{}-{}-7-0123456789abcdef", here, dead, dead),  // of the host HERE-PID
      fmt::format(".part-{}x-{}-7-0123456789abcdef", here, dead),          // of another host
      fmt::format(".part-{}-{}-0123456789abcdef", here, dead),             // no start
      ".part-",
  };
  const std::string go[] = {
      fmt::format(".part-{}-{}-7-0123456789abcdef", here, dead),
      fmt::format(".part-{}7-0123456789abcdef", live),  // of an earlier process of the same number
  };
  for (const std::string& name : stay) fs::create_directories(folder / ("out/points/" + name + "/sub"));
  for (const std::string& name : go) fs::create_directories(folder / ("out/points/" + name + "/sub"));
  folder.file(fmt::format("out/.part-{}-{}-7-results.csv", here, dead), "half");
  CHECK_THAT(folder.sweep(five).out, Contains("5 points: 0 run now"));
  for (const std::string& name : stay) {
    INFO(name);
    CHECK(fs::exists(folder / ("out/points/" + name)));
  }
  CHECK(names_in(folder / "out/points").size() == 5 + std::size(stay));
  CHECK(names_in(folder / "out") == words{"failed", "lock", "points", "results.csv", "results.json", "sweep.json"});
}

TEST_CASE("sweep: signals leave whole points, no parts and no workers", "[testbench]") {
  const sweep_folder folder;
  folder.file("sweep.toml", header + "images = [\"png\"]\n[axes]\n\"rtu.cores\" = {from = 1, to = 60}\n");
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    fs::remove_all(folder / "out");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> err(std::tmpfile(), &std::fclose);
    const pid_t child = start_rtusim(folder, {"sweep", "sweep.toml", "--out", "out", "-j", "2"}, stdout, err.get());
    int status = 0;
    while (!fs::exists(folder / "out/points") && waitpid(child, &status, WNOHANG) == 0) continue;
    kill(child, number);
    waitpid(child, &status, 0);
    CHECK(WEXITSTATUS(status) == 1);
    CHECK_THAT(text_so_far(err.get()), Contains(" of 60 points are done, and the same command goes on\n"));
    CHECK(names_in(folder / "out") == words{"failed", "lock", "points", "sweep.json"});
    for (const std::string& name : names_in(folder / "out/points")) {
      CHECK(name[0] != '.');
      CHECK(names_in(folder / ("out/points/" + name)) == words{"identity.json", "image.png", "stats.json"});
    }
  }
  CHECK(rtusim(folder, {"sweep", "sweep.toml", "--out", "out"}).status == 0);
}

TEST_CASE("sweep: what a loss of power tore is run again, and a torn mark is written anew", "[testbench]") {
  const sweep_folder folder;
  const std::string lines = header + "images = [\"png\"]\n[axes]\n\"rtu.cores\" = [1, 2, 3, 4, 5]\n";
  CHECK(folder.sweep(lines).status == 0);
  const std::string csv = bytes_of(folder / "out/results.csv");
  const auto points = names_in(folder / "out/points");
  const auto put = [&](std::size_t point, const char* name, const std::string& bytes) {
    folder.file("out/points/" + points[point] + '/' + name, bytes);
  };
  const std::string record = bytes_of(folder / ("out/points/" + points[0] + "/stats.json"));
  put(0, "stats.json", "");
  put(1, "stats.json", record.substr(0, record.size() / 2));
  put(2, "identity.json", "");
  put(3, "image.png", "");
  CHECK_THAT(folder.sweep(lines).out, Contains("5 points: 4 run now, 1 there before"));
  CHECK(bytes_of(folder / "out/results.csv") == csv);
  CHECK(bytes_of(folder / ("out/points/" + points[3] + "/image.png")).size() > 100);

  const std::string mark = bytes_of(folder / "out/sweep.json");
  for (const std::string& torn :
       {std::string(), mark.substr(0, 10), std::string(mark.size(), '\0'), mark.substr(0, 10) + std::string(5, '\0')}) {
    folder.file("out/sweep.json", torn);
    folder.file("out/results.csv", "");
    CHECK_THAT(folder.sweep(lines).out, Contains("5 points: 0 run now, 5 there before"));
    CHECK(bytes_of(folder / "out/sweep.json") == mark);
    CHECK(bytes_of(folder / "out/results.csv") == csv);
  }
  folder.file("out/letter", "");
  folder.file("out/sweep.json", "");
  CHECK_THAT(folder.sweep(lines).err, Contains("out/sweep.json: no mark of a sweep's results"));
}

TEST_CASE("sweep: a link in its folder leads nothing out of it", "[testbench]") {
  const sweep_folder folder;
  folder.file("precious", "kept");
  fs::create_directories(folder / "out/points");
  folder.file("out/sweep.json", "{\"format\":\"rtusim sweep\",\"version\":2}\n");
  for (const char* name : {"results.csv", "results.json"}) fs::create_symlink("../precious", folder / (std::string("out/") + name));
  CHECK(folder.sweep(five).status == 0);
  CHECK(bytes_of(folder / "precious") == "kept");
  CHECK(fs::symlink_status(folder / "out/results.csv").type() == fs::file_type::regular);
  CHECK(rows_of(folder / "out/results.csv").size() == 5);
}

TEST_CASE("sweep: folders whose names are no UTF-8, or begin like an option", "[testbench]") {
  const scratch_folder folder;
  const fs::path home = lay_out(folder,
                                "gr\xfc\xdf"
                                "e, 'quoted'",
                                "dragon_32");
  for (const char* out : {"out", "-x"}) {
    INFO(out);
    const outcome o = rtusim(home, {"sweep", "sweep.toml", std::string("--out=") + out});
    CHECK(o.status == 0);
    CHECK(o.err.empty());
    const std::string point = names_in(home / out / "points").front();
    CHECK(rtusim(home / out, {"rerun", "points/" + point + "/stats.json"}).status == 0);
  }
  CHECK(rtusim(folder, {"sweep", (home / "sweep.toml").string(), "--out", (home / "out").string()}).status == 0);
  CHECK(bytes_of(home / "out/results.csv") == bytes_of(home / "-x/results.csv"));
  // Of a scene there that can't be run the table tells the same from everywhere.
  std::ofstream(home / "scene.toml") << "[scene]\nmodel = \"none.svo\"\n";
  CHECK(rtusim(home, {"sweep", "sweep.toml", "--out", "out"}).status == 1);
  const std::string csv = bytes_of(home / "out/results.csv");
  CHECK_THAT(csv, Contains(",none.svo: no such file; "));
  CHECK(rtusim(folder, {"sweep", (home / "sweep.toml").string(), "--out", (home / "out").string()}).status == 1);
  CHECK(bytes_of(home / "out/results.csv") == csv);
}

TEST_CASE("sweep: a Slurm array's points, and those of one that was cancelled", "[testbench]") {
  const scratch_folder folder;
  const fs::path home = lay_out(folder, "a 'b' \xff", "dragon_32");
  CHECK(rtusim(home, {"sweep", "sweep.toml", "--out", "whole"}).status == 0);
  fs::create_directories(folder / "bin");
  // Runs the tasks that LAST lets it, one after the other.
  const fs::path sbatch =
      folder.file("bin/sbatch",
                  "#!/bin/sh\necho Submitted batch job 1\n"
                  "for i in $(seq 0 \"$(cat \"${0%/*}/last\")\"); do SLURM_ARRAY_TASK_ID=$i sh \"$2\" || exit 1; done\n");
  fs::permissions(sbatch, fs::perms::owner_all);
  const std::string path = (folder / "bin").string() + ":/usr/bin:/bin";
  limits with_slurm;
  with_slurm.path = path.c_str();
  const auto run = [&](const char* last, const char* out) {
    folder.file("bin/last", last);
    return rtusim(home, {"sweep", "sweep.toml", "--engine", "slurm", "-j", "2", std::string("--out=") + out}, with_slurm);
  };
  for (const char* out : {"out", "-x"}) {
    const outcome o = run("1", out);
    CHECK(o.status == 0);
    CHECK_THAT(o.out, Contains("5 points: 5 run now, 0 there before"));
    CHECK(bytes_of(home / out / "results.csv") == bytes_of(home / "whole/results.csv"));
  }
  const outcome cancelled = run("0", "half");
  CHECK(cancelled.status == 1);
  CHECK_THAT(cancelled.err, Contains("rtusim: 2 points failed: not run\n") && Contains("2 of 5 points failed"));
  CHECK_THAT(run("1", "half").out, Contains("5 points: 2 run now, 3 there before"));
}

TEST_CASE("sweep: values that take back what a scene gives, and tables with units", "[testbench]") {
  const sweep_folder folder;
  folder.file("scene.toml", bytes_of(folder / "scene.toml") + "[camera]\nposition = [1, 2, 3]\n");
  const std::string lines = header + "record = [\"rays\", \"cycles_per_ray\"]\n[axes]\n\"camera.kind\" = [\"orbit\"]\n";
  CHECK_THAT(folder.sweep(lines).out, Contains("1 failed"));
  const outcome o =
      folder.sweep(lines +
                       "\"camera.position\" = [\"default\"]\n\"rtu.cores\" = [4]\n\"rtu.clock_mhz\" = {from = 0.1, to = 0.3, step = 0.2}\n"
                       "\"driver.last_sign_only\" = [false]\n\"camera.target\" = [[0, 0.1, -0.25]]\n",
                   "out", {"--units"});
  CHECK(o.err.empty());
  const auto rows = rows_of(folder / "out/results.csv");
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].at("rtu.cores") == "cores");
  CHECK(rows[0].at("rtu.clock_mhz") == "MHz");
  CHECK(rows[0].at("cycles_per_ray") == "cycles");
  CHECK(rows[0].at("point").empty());
  CHECK(rows[1].at("camera.position") == "default");
  CHECK(rows[1].at("camera.target") == "[ 0, 0.1, -0.25 ]");
  CHECK(rows[2].at("rtu.clock_mhz") == "0.3");
  CHECK(nlohmann::json::parse(bytes_of(folder / "out/results.json"))["points"][1]["axes"] ==
        nlohmann::json::parse(R"({"camera.kind": "orbit", "camera.position": "default", "rtu.cores": 4, "rtu.clock_mhz": 0.3,
                                  "driver.last_sign_only": false, "camera.target": [0, 0.1, -0.25]})"));
}

TEST_CASE("The sources' checksum is that of their names and contents, wherever they lie", "[testbench]") {
  const scratch_folder folder;
  const auto checksum = [&](const char* tree) {
    const std::string command = fmt::format("'{}' '-DROOT={}' '-DOUTPUT={}' -P '{}'", RTUSIM_CMAKE, (folder / tree).string(),
                                            (folder / "made.cpp").string(), RTUSIM_SOURCE_DIR "/testbench/sweep/source_checksum.cmake");
    REQUIRE(std::system(command.c_str()) == 0);
    const std::string text = bytes_of(folder / "made.cpp");
    return text.substr(text.find("return \""));
  };
  for (const char* tree : {"a", "b"}) {
    for (const char* sub : {"modules/x", "scenes", "testbench/tests"}) fs::create_directories(folder / (std::string(tree) + '/' + sub));
    folder.file(std::string(tree) + "/modules/x/x.cpp", "1");
    folder.file(std::string(tree) + "/scenes/s.h", "2");
  }
  std::set<std::string> seen{checksum("a")};
  CHECK(checksum("b") == checksum("a"));
  folder.file("b/testbench/tests/t.cpp", "3");
  CHECK(checksum("b") == checksum("a"));
  folder.file("b/modules/x/x.cpp", "2");
  CHECK(seen.insert(checksum("b")).second);
  fs::rename(folder / "a/scenes/s.h", folder / "a/scenes/t.h");
  CHECK(seen.insert(checksum("a")).second);
  folder.file("a/testbench/u.h", "");
  CHECK(seen.insert(checksum("a")).second);
}

}  // namespace
}  // namespace rtusim
