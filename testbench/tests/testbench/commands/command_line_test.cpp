#include <catch2/catch.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/files.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

using test::bytes_of;
using test::outcome;
using test::rtusim;
using test::words;

const std::string source = RTUSIM_SOURCE_DIR "/";
const std::string golden = source + "testbench/golden/svo/";
const std::string as_built = source + "testbench/architectures/espe2019_as_built.toml";
const std::string teapot = source + "scenes/data/teapot.bpt";
const std::string dragon = golden + "models/dragon_32.svo";

/// A run of 144 rays, which `also` changes.
words small_run(const words& also) {
  words all{"run", "--model", dragon, "--set", "frame.width=16", "--set", "frame.height=9", "--quiet"};
  all.insert(all.end(), also.begin(), also.end());
  return all;
}

/// What lies in a folder: the bytes of its files by name, the hidden ones too.
std::map<std::string, std::string> contents(const test::scratch_folder& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / ""))
    files[entry.path().filename().string()] = entry.is_regular_file() ? bytes_of(entry) : "";
  return files;
}

struct refusal {
  const char* what;
  words arguments;
  std::string text;  // part of the one line that it brings
  int status = 2;
  rlim_t most_bytes = RLIM_INFINITY;
};

void check_refused(const test::scratch_folder& folder, const refusal& r) {
  INFO(r.what);
  const auto before = contents(folder);
  const outcome o = rtusim(folder, r.arguments, r.most_bytes);
  CHECK(o.status == r.status);
  CHECK(o.out.empty());
  CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
  CHECK_THAT(o.err, Catch::StartsWith("rtusim: ") && Catch::EndsWith("\n") && Catch::Contains(r.text));
  CHECK(contents(folder) == before);
}

TEST_CASE("command line: a command that can't be read is refused", "[testbench]") {
  const test::scratch_folder folder;
  const refusal all[] = {
      {"no command", {}, "command: none; expected one of run, unit"},
      {"an unknown command", {"rum"}, "command: \"rum\"; expected one of run, unit"},
      {"an unknown option", small_run({"--vdc-from", "3"}), "run: unknown argument \"--vdc-from\"; expected --vcd-from"},
      {"a second scene", {"run", "a.toml", "b.toml"}, "unknown argument \"b.toml\""},
      {"a waveform of a replay", small_run({"--pace", "replay", "--vcd", "w.vcd"}), "--vcd: --pace replay, which has no signals; expected"},
      {"a key explained for a design",
       {"explain", "rtu.cores", "--set", "rtu.cores=4"},
       "explain: --arch or --set with \"rtu.cores\"; expected them with timing alone"},
      {"a page of one key", {"explain", "rtu.cores", "--markdown"}, "explain: --markdown with \"rtu.cores\"; expected it alone"},
      {"an octree in no voxels", {"convert", dragon, "a.binvox", "--resolution", "0"}, "--resolution: 0; expected 1 to "},
      {"an option without its value", small_run({"--log"}), "--log"},
      {"an option given twice", small_run({"--log", "a", "--log", "b"}), "--log"},
      {"an empty name, as of a variable that is not set", small_run({"--log", ""}), "--log: an empty value"},
      {"a unit without files", {"unit", "svo_core"}, "--jobs is required"},
      {"an unknown unit",
       {"unit", "svo_coar", "--jobs", "a.csv", "--out", "b.csv"},
       "\"svo_coar\"; expected svo_core, float_to_fixed, t_div,"},
      {"a unit without its model", {"unit", "svo_core", "--jobs", "a.csv", "--out", "b.csv"}, "no --model"},
      {"a unit without its memories", {"unit", "bih_core", "--jobs", "a.csv", "--out", "b.csv"}, "unit bih_core: no --memory"},
      {"a unit with another's memories",
       {"unit", "svo_core", "--jobs", "a.csv", "--out", "b.csv", "--memory", "m"},
       "unit svo_core: --memory; expected bih_core"},
      {"a unit with another's model",
       {"unit", "bih_core", "--jobs", "a.csv", "--out", "b.csv", "--model", dragon},
       "unit bih_core: --model"},
      {"memories that are not there",
       {"unit", "bih_core", "--jobs", "a.csv", "--out", "b.csv", "--memory", "none"},
       "none: no such folder"},
      {"an unknown key", {"explain", "scheduler.polcy"}, "unknown key scheduler.polcy; expected scheduler.policy"},
      {"an unknown figure", {"explain", "statistics.rasy"}, "expected statistics.rays"},
      {"letters that changed places", {"explain", "rtu.coers"}, "unknown key rtu.coers; expected rtu.cores"},
      {"the end of a figure's key", {"explain", "latnecy"}, "no figure latnecy; expected latency"},
      {"no model", {"run"}, "run: no model; expected a scene file, --model FILE"},
      {"a mesh in so many voxels",
       {"run", "--model", teapot, "--set", "scene.resolution=33"},
       "scene.resolution: 33; expected a power of two up to 1024"},
      {"a replay with long pauses",
       small_run({"--pace", "replay", "--set", "source.valid=gap", "--set", "source.gap_cycles=100000", "--set", "watchdog.cycles=5000"}),
       "--pace replay: transfers more than watchdog.cycles = 5000 apart; expected --pace skipping for such a run"},
      {"a pace that is none", small_run({"--pace", "faster"}), "--pace: \"faster\"; expected skipping, stepped"},
  };
  for (const refusal& r : all) check_refused(folder, r);
}

TEST_CASE("command line: the version, which a record tells, too", "[testbench]") {
  const test::scratch_folder folder;
  const outcome o = rtusim(folder, {"--version"});
  CHECK(o.status == 0);
  CHECK(o.err.empty());
  CHECK_THAT(o.out, Catch::Matches(R"(rtusim \d+\.\d+\.\d+ \((unknown|[0-9a-f]{7,40}\+?)\)\n)"));
  REQUIRE(rtusim(folder, small_run({"--stats", "s.json"})).status == 0);
  CHECK(o.out == "rtusim " + nlohmann::json::parse(bytes_of(folder / "s.json"))["simulator"]["version"].get<std::string>() + '\n');
}

TEST_CASE("command line: a parameter that is unknown, unread or out of range is refused", "[testbench]") {
  const test::scratch_folder folder;
  const auto set = [](const std::string& assignment) { return small_run({"--set", assignment}); };
  const refusal all[] = {
      {"no key", set("=3"), "expected KEY=VALUE"},
      {"letters that changed places", set("rtu.coers=4"), "unknown key rtu.coers; expected rtu.cores"},
      {"a mistyped key", set("sceduler.policy=first_available"), "unknown key sceduler.policy; expected scheduler.policy"},
      {"a mistyped word", set("scheduler.policy=round_robbin"), "did you mean round_robin?"},
      {"a key that nothing reads", set("source.gap_cycles=4"), "source.gap_cycles is not read by this design"},
      {"voxels of what is no mesh", set("scene.resolution=64"), "it only when scene.model is a mesh"},
      {"zero cores", set("rtu.cores=0"), "rtu.cores = 0; expected a whole number from 1 to"},
      {"more cores than there can be", set("rtu.cores=99999999999999999999"), "rtu.cores"},
      {"a word for a number", set("rtu.cores=many"), "rtu.cores = \"many\"; expected a whole number"},
      {"a frame without columns", set("frame.width=0"), "frame.width = 0; expected a whole number from 1 to"},
      {"a camera that is nowhere", set("camera.position=[nan, 0, 0]"), "camera.position = [nan, 0, 0]; expected an array of three finite"},
      {"an endless camera", set("camera.far=inf"), "camera.far = inf; expected a finite number"},
      {"a camera that ends before it begins", set("camera.near=1000000"), "camera: far = "},
      {"a camera without an opening", set("camera.vertical_fov_degrees=180"), "camera.vertical_fov_degrees = 180; expected"},
  };
  for (const refusal& r : all) check_refused(folder, r);
}

TEST_CASE("command line: a file that can't be used is refused with its place", "[testbench]") {
  const test::scratch_folder folder;
  const std::string svo = config::read_file(dragon);
  const std::string ply = config::read_file(source + "scenes/data/dragon_res4.ply");
  std::filesystem::create_directory(folder / "folder");
  folder.file("empty", "");
  folder.file("garbage.toml",
              "\x7f"
              "ELF\x02\x01 = [");
  folder.file("cut.toml", "[frame]\nwidth = ");
  folder.file("unknown.toml", "[frame]\nwidht = 3\n");
  folder.file("foreign.toml", "\n[rtu]\ncores = 3\n");
  folder.file("twice.toml", "[frame]\nwidth = 3\nwidth = 4\n");
  folder.file("mistyped.toml", "[frame]\n\nwidth = \"3\"\n");
  folder.file("nan.toml", "[camera]\nposition = [0.0, nan, 0.0]\n");
  folder.file("no_model.toml", "[scene]\nmodel = \"nothing.svo\"\n");
  folder.file("cut.svo", svo.substr(0, 1000));
  folder.file("odd.svo", svo.substr(0, 1001));
  folder.file("loop.svo", std::string("\x00\x01\x00\x00", 4));
  folder.file("garbage.svo", "not an octree...");
  folder.file("cut.svo.gz", std::string("\x1f\x8b\x08\x00\x00\x00\x00\x00", 8));
  folder.file("cut.ply", ply.substr(0, ply.size() / 2));
  folder.file("garbage.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n");
  folder.file("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.file("beyond.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  folder.file("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  folder.file("odd.bin", std::string(33, 'j'));
  folder.file("beyond.bin", std::string(32, '\x0f'));
  folder.file("header.csv", "id,float_bits\n1\n");
  folder.file("column.csv", "id,floats\n1,2\n");
  folder.file("word.csv", "id,float_bits\n1,2\n2,x\n");
  const auto model = [](const std::string& name) { return words{"run", "--quiet", "--model", name}; };
  const auto scene = [](const std::string& name) { return words{"run", "--quiet", name, "--model", dragon}; };
  const auto jobs = [](const std::string& name) { return small_run({"--jobs", name, "--log", "log.csv"}); };
  const auto unit = [](const std::string& name) { return words{"unit", "float_to_fixed", "--jobs", name, "--out", "out.csv"}; };
  const refusal all[] = {
      {"no scene", scene("none.toml"), "none.toml: no such file"},
      {"a folder for a scene", scene("folder"), "folder: a folder; expected a file"},
      {"a scene that can't be read", scene("/proc/self/mem"), "/proc/self/mem: "},
      {"garbage for a scene", scene("garbage.toml"), "garbage.toml:1:1: "},
      {"half a scene", scene("cut.toml"), "cut.toml:2:"},
      {"a mistyped key", scene("unknown.toml"), "unknown.toml:2: unknown key frame.widht; expected frame.width"},
      {"a key of a design in a scene", scene("foreign.toml"), "foreign.toml:3: rtu.cores belongs in an architecture file"},
      {"a key given twice", scene("twice.toml"), "twice.toml:3:"},
      {"a value of another type", scene("mistyped.toml"), "mistyped.toml:3: frame.width = \"3\"; expected a whole number"},
      {"a camera that is nowhere", scene("nan.toml"), "nan.toml:2: camera.position = [0.0, nan, 0.0]"},
      {"a scene of a model that is not there", {"run", "no_model.toml"}, "nothing.svo: no such file"},
      {"no design", small_run({"--arch", "none.toml"}), "none.toml: no such file"},
      {"no octree", model("none.svo"), "none.svo: no such file"},
      {"half an octree", model("cut.svo"), "cut.svo: word "},
      {"an octree and a byte", model("odd.svo"), "odd.svo: 1001 bytes"},
      {"an octree that bites its tail", model("loop.svo"), "loop.svo: word "},
      {"garbage for an octree", model("garbage.svo"), "garbage.svo: word 0"},
      {"half a zipped octree", model("cut.svo.gz"), "cut.svo.gz: broken gzip data (it is cut short)"},
      {"a model of another kind", model("odd.bin"), "odd.bin: a mesh ending in \".bin\""},
      {"half a mesh", model("cut.ply"), "cut.ply"},
      {"a mesh that claims too much", model("garbage.ply"), "garbage.ply"},
      {"a mesh with a vertex nowhere", model("nan.obj"), "nan.obj"},
      {"a face without its vertex", model("beyond.obj"), "beyond.obj"},
      {"a mesh without extent", model("point.obj"), "point.obj: a mesh without extent"},
      {"no file to describe", {"info", "none.svo"}, "none.svo: no such file"},
      {"no jobs", jobs("none.bin"), "none.bin: no such file"},
      {"a file without jobs", jobs("empty"), "empty: no jobs"},
      {"a job and a byte", jobs("odd.bin"), "odd.bin: 33 bytes; expected a multiple of 32"},
      {"jobs of another frame", small_run({"--jobs", "beyond.bin", "--image", "out.png"}), "beyond.bin: 1 job ids beyond the frame"},
      {"no words", unit("none.csv"), "none.csv: no such file"},
      {"a table of nothing", unit("empty"), "empty: an empty file; expected a header line"},
      {"a row that is cut", unit("header.csv"), "header.csv:2: 1 fields; expected 2"},
      {"a column that is not there", unit("column.csv"), "column.csv:1: no column float_bits"},
      {"a word that is none", unit("word.csv"), "word.csv:3: float_bits = \"x\"; expected a whole number"},
  };
  for (const refusal& r : all) check_refused(folder, r);
}

TEST_CASE("command line: a list of rays that can't be used is refused with its place", "[testbench]") {
  const test::scratch_folder folder;
  const std::string header = "ox,oy,oz,dx,dy,dz\n";
  folder.file("empty.csv", "");
  folder.file("header.csv", header);
  folder.file("column.csv", "ox,oy,oz,dx,dy\n1,2,3,4,5\n");
  folder.file("cut.csv", header + "0,0,2,0,0,-1\n0,0,2,0\n");
  folder.file("word.csv", header + "0,0,2,0,0,-1\n0,0,2,0,0x1,-1\n");
  folder.file("blank.csv", header + "0,0,,0,0,-1\n");
  folder.file("beyond.csv", header + "0,0,1e39,0,0,-1\n");
  folder.file("good.csv", header + "0,0,2,0,0,-1\n");
  folder.file("cut.bin", std::string(47, '\0'));
  folder.file("none.bin", "");
  folder.file("rays.txt", header);
  folder.file("jobs.bin", std::string(32, '\0'));
  folder.file("camera.toml", "[scene]\nrays = \"good.csv\"\n\n[camera]\nnear = 0.1\n");
  const auto rays = [](const std::string& name, const words& also = {}) {
    words all{"run", "--model", dragon, "--quiet", "--log", "log.csv", "--set", "scene.rays=" + name};
    all.insert(all.end(), also.begin(), also.end());
    return all;
  };
  const refusal all[] = {
      {"no list", rays("nowhere.csv"), "nowhere.csv: no such file"},
      {"an empty file", rays("empty.csv"), "empty.csv: an empty file"},
      {"no rays in a table", rays("header.csv"), "header.csv: no rays"},
      {"no rays in words", rays("none.bin"), "none.bin: no rays"},
      {"a column that is not there", rays("column.csv"), "column.csv:1: no column dz"},
      {"a row that is cut", rays("cut.csv"), "cut.csv:3: 4 fields; expected 6"},
      {"a word that is no number", rays("word.csv"), "word.csv:3: dy = \"0x1\"; expected a number within binary32, inf or nan"},
      {"no word", rays("blank.csv"), "blank.csv:2: oz = \"\"; expected a number"},
      {"a number beyond binary32", rays("beyond.csv"), "beyond.csv:2: oz = \"1e39\"; expected a number within binary32"},
      {"words that end within a ray", rays("cut.bin"), "cut.bin: 47 bytes; expected a multiple of 24"},
      {"a list of no known kind", rays("rays.txt"), "rays.txt: a ray list ending in \".txt\"; expected .csv or .bin"},
      {"a camera beside the list", {"run", "camera.toml", "--model", dragon}, "camera.toml:5: camera.near is not read by this design"},
      {"a list and jobs", rays("good.csv", {"--jobs", "jobs.bin"}), "--jobs: with scene.rays; expected one or the other"},
      {"a picture of another size", rays("good.csv", {"--image", "out.png"}),
       "good.csv: 1 rays for a frame of 1280 x 720; expected frame.width"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  CHECK(rtusim(folder, rays("good.csv", {"--image", "out.sheet.png", "--set", "frame.width=1", "--set", "frame.height=1"})).status == 0);
  CHECK(contents(folder).count("out.sheet.png") == 1);
}

TEST_CASE("command line: a list of a camera's rays gives the camera's packets and results, on both kinds of cores", "[testbench]") {
  const test::scratch_folder folder;
  // Parallel rays along -z, whose words are exact.
  std::string table = "ox,oy,oz,dx,dy,dz\n";
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) table += fmt::format("{},{},2,0,0,-1\n", (x + 0.5 - 16) / 8, -(y + 0.5 - 8) / 8);
  folder.file("rays.csv", table);
  const std::string mesh = source + "scenes/data/dragon_res4.ply";
  for (const words& design : {words{"--model", dragon}, words{"--model", mesh, "--set", "rtu.core=bih", "--set", "rtu.cores=1"}}) {
    words common{"run", "--quiet", "--set", "frame.width=32", "--set", "frame.height=16"};
    common.insert(common.end(), design.begin(), design.end());
    words eye = common, list = common;
    for (const char* set : {"camera.kind=look_at", "camera.projection=orthographic", "camera.position=[0, 0, 2]", "camera.height=2"})
      eye.insert(eye.end(), {"--set", set});
    eye.insert(eye.end(), {"--save-jobs", "eye.bin", "--log", "eye.csv", "--image", "eye.png"});
    list.insert(list.end(), {"--set", "scene.rays=rays.csv", "--save-jobs", "list.bin", "--log", "list.csv", "--image", "list.png"});
    CHECK(rtusim(folder, eye).status == 0);
    CHECK(rtusim(folder, list).status == 0);
    const auto files = contents(folder);
    CHECK((files.at("eye.bin") == files.at("list.bin")));
    CHECK((files.at("eye.csv") == files.at("list.csv")));
    CHECK((files.at("eye.png") == files.at("list.png")));
    CHECK_THAT(files.at("list.csv"), Catch::Contains(",1,"));
  }
}

TEST_CASE("command line: rays that are no numbers are traced and warned about", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n0,0,2,0,0,-1\nnan,0,2,0,0,-1\n0,0,inf,0,nan,-1\n0,0,2,inf,0,0\n0,0,2,0,0,0\n");
  const std::string mesh = source + "scenes/data/dragon_res4.ply";
  for (const words& design : {words{"--model", dragon}, words{"--model", mesh, "--set", "rtu.core=bih", "--set", "rtu.cores=1"}}) {
    words all{"run", "--quiet", "--set", "scene.rays=rays.csv", "--set", "frame.width=5", "--set", "frame.height=1"};
    all.insert(all.end(), {"--image", "out.sheet.png", "--image", "out.exr"});
    all.insert(all.end(), design.begin(), design.end());
    const outcome o = rtusim(folder, all);
    CHECK(o.status == 0);
    CHECK_THAT(o.err, Catch::StartsWith("rtusim: warning: ") && Catch::Contains("are no number"));
  }
}

TEST_CASE("command line: a triangle unit's input that can't be used is refused with its place", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("division.csv", "n,d\n1,2\n");
  folder.file("column.csv", "n,q\n1,2\n");
  folder.file("word.csv", "n,d\n1,2\n1,9223372036854775808\n");
  std::string header = "en,pos_x,pos_y,pos_z,dir_x,dir_y,dir_z,r,pp,pq,d,np,nq,e1p,e1q,e2p,e2q\n";
  folder.file("enable.csv", header + "2,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n");
  folder.file("axis.csv", header + "1,0,0,0,0,0,0,4,0,0,0,0,0,0,0,0,0\n");
  folder.file("none.csv", header);
  folder.file("without.csv", header.replace(header.find("e1q"), 3, "e1r") + "1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n");
  const auto t_div = [](const std::string& name, const words& also = {}) {
    words all{"unit", "t_div", "--jobs", name, "--out", "out.csv"};
    all.insert(all.end(), also.begin(), also.end());
    return all;
  };
  const auto triangles = [](const std::string& name, const words& also = {}) {
    words all{"unit", "triangle_unit", "--jobs", name, "--out", "out.csv"};
    all.insert(all.end(), also.begin(), also.end());
    return all;
  };
  const refusal all[] = {
      {"no divisor", t_div("column.csv"), "column.csv:1: no column d"},
      {"a word of 65 bits", t_div("word.csv"), "word.csv:3: d = \"9223372036854775808\"; expected a whole number"},
      {"a divider of 3 bits", t_div("division.csv", {"--set", "t_div.width=3"}), "t_div.width = 3; expected a whole number from 4 to 64"},
      {"a divider of 65 bits", t_div("division.csv", {"--set", "t_div.width=65"}),
       "t_div.width = 65; expected a whole number from 4 to 64"},
      {"a divider of no kind", t_div("division.csv", {"--set", "t_div.kind=serial"}),
       "t_div.kind = \"serial\"; expected pipelined or iterative"},
      {"a divider's model", t_div("division.csv", {"--model", dragon}), "unit t_div: --model; expected no octree"},
      {"an edge that is not there", triangles("without.csv"), "without.csv:1: no column e1q"},
      {"an enable of 2", triangles("enable.csv"), "enable.csv:2: en = \"2\"; expected a whole number from 0 to 1"},
      {"a fifth axis", triangles("axis.csv"), "axis.csv:2: r = \"4\"; expected a whole number from 0 to 3"},
      {"coordinates of 3 bits", triangles("none.csv", {"--set", "quantisation.n=3"}),
       "quantisation.n = 3; expected a whole number from 4 to 32"},
      {"more bits dropped than there are", triangles("none.csv", {"--set", "quantisation.n=8", "--set", "quantisation.division_drop=8"}),
       "quantisation.division_drop: 8; expected at most n - 1 = 7"},
      {"triangles where there are none", small_run({"--set", "quantisation.n=12"}), "quantisation.n is not read by this design"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  CHECK(rtusim(folder, triangles("none.csv")).status == 0);
  CHECK_THAT(contents(folder).at("out.csv"), Catch::EndsWith(",e2q,rdy,hit,u,v,t\n"));
}

TEST_CASE("command line: a mesh that triangle cores can't trace is refused with its reason", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  folder.file("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  folder.file("flat.obj", "v 0 0 5\nv 1 0 5\nv 0 1 5\nf 1 2 3\n");
  folder.file("thin.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 1e-10\nf 1 2 3\nf 1 4 3\n");
  folder.file("slivers.obj", "v 0 0 0\nv 1 0.5 0.5\nv 1 0.500001 0.5\nf 1 2 3\n");
  // Each split takes the outermost triangle away: 2^29, 2^28, ... along x, y and z.
  std::string deep = "v 0 0 0\nv 1073741823 0 0\nv 0 1073741823 0\nv 0 0 1073741823\n";
  unsigned vertices = 4;
  for (unsigned axis = 0; axis < 3; ++axis)
    for (unsigned bit = 3; bit < 29; ++bit) {
      long corner[3] = {0, 0, 0};
      corner[axis] = 1L << bit;
      const std::string x = std::to_string(corner[0]), y = std::to_string(corner[1]), z = std::to_string(corner[2]);
      deep += "v " + x + ' ' + y + ' ' + z + "\nv " + std::to_string(corner[0] + 1) + ' ' + y + ' ' + z + "\nv " + x + ' ' +
              std::to_string(corner[1] + 1) + ' ' + std::to_string(corner[2] + 1) + '\n';
      deep += "f " + std::to_string(vertices + 1) + ' ' + std::to_string(vertices + 2) + ' ' + std::to_string(vertices + 3) + '\n';
      vertices += 3;
    }
  folder.file("deep.obj", deep + "f 2 3 4\n");
  folder.file("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 4\n");
  const auto bih = [](const std::string& model, const words& also = {}) {
    words all{"run", "--quiet", "--arch", source + "testbench/architectures/hanika2007.toml", "--model", model, "--log", "log.csv"};
    all.insert(all.end(), also.begin(), also.end());
    return all;
  };
  const refusal all[] = {
      {"no mesh", bih("none.ply"), "none.ply: no such file"},
      {"a mesh without triangles", bih("none.obj"), "none.obj: no faces; expected a mesh of triangles or polygons"},
      {"a mesh without an area", bih("line.obj"), "line.obj: no face has an area; expected a mesh of triangles or polygons"},
      {"a vertex that is not there", bih("cut.obj"), "cut.obj"},
      {"a flat box", bih("flat.obj"), "flat.obj: a flat mesh: no extent along z on a grid of 2^30; expected a box with a volume"},
      {"a box thinner than the grid", bih("thin.obj"), "thin.obj: a flat mesh: no extent along z on a grid of 2^30"},
      {"triangles finer than the grid", bih("slivers.obj", {"--set", "quantisation.n=8"}),
       "slivers.obj: no triangle has an area on a grid of 2^8"},
      {"leaves without triangles", bih(teapot, {"--set", "bih_builder.leaf_triangles=0"}),
       "bih_builder.leaf_triangles = 0; expected a whole number from 1 to 4096 triangles"},
      {"leaves of too many", bih(teapot, {"--set", "bih_builder.leaf_triangles=4097"}), "bih_builder.leaf_triangles = 4097; expected"},
      {"more than the memories as built hold",
       {"run", "--quiet", "--arch", source + "testbench/architectures/hanika2007_as_built.toml", "--model",
        source + "scenes/data/dragon_res3.ply.gz"},
       "47794 triangles; expected at most 992 of each for bih_core.address_bits = 10; 16 would do"},
      {"the bits that would do, less one", bih(teapot, {"--set", "bih_core.address_bits=12"}),
       "of 6320 triangles; expected at most 4064 of each for bih_core.address_bits = 12; 13 would do"},
      {"more levels than the stack has entries", bih("deep.obj", {"--set", "bih_builder.leaf_triangles=1"}),
       "a ray may push 32 entries on its way here; expected at most 31"},
      {"an octree", bih(dragon), "dragon_32.svo: voxels, which triangle cores can't trace; expected a mesh"},
      {"a replay", bih(teapot, {"--pace", "replay", "--set", "t_div.kind=iterative"}),
       "--pace replay: an iterative divider, which lets a ray wait for the one before; expected a design whose schedule follows from the "
       "costs of its rays"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  const words view{"--set", "frame.width=8", "--set", "frame.height=6"};
  words held = bih(teapot, view), clamped = bih("deep.obj", view);
  held.insert(held.end(), {"--set", "bih_core.address_bits=13"});
  clamped.insert(clamped.end(), {"--set", "bih_builder.leaf_triangles=79"});
  CHECK(rtusim(folder, held).status == 0);
  words away = bih(teapot, view);
  away.insert(away.end(), {"--set", "camera.kind=look_at", "--set", "camera.position=[0, 0, 5]", "--set", "camera.target=[0, 0, 9]"});
  check_refused(folder,
                {"a camera that looks away", away, "camera: no ray meets the box of the model; expected a camera that looks at it"});
  away.insert(away.end(), {"--set", "driver.skip_misses=false"});
  CHECK(rtusim(folder, away).status == 0);
  // Tiny triangles have long edges in their units: that is told, and the run goes on.
  const outcome o = rtusim(folder, clamped);
  CHECK(o.status == 0);
  CHECK_THAT(o.err, Catch::StartsWith("rtusim: warning: of the triangles 0 lost their area on the grid, ") &&
                        Catch::EndsWith(" have edges beyond edge_shift and were clamped\n"));
}

TEST_CASE("command line: what a design of the other kind reads is refused, and what is out of range", "[testbench]") {
  const test::scratch_folder folder;
  const auto bih = [](const std::string& assignment) {
    return words{"run", "--quiet", "--arch", source + "testbench/architectures/hanika2007.toml", "--model", teapot, "--set", assignment};
  };
  for (const std::string key :
       {"svo_core.stack_depth=3", "svo_core.tm_wrap=true", "fixed_point.integer_bits=12", "fixed_point.fraction_bits=12",
        "float_to_fixed.flush_small=true", "memory.address_bits=12", "driver.last_sign_only=true"}) {
    const std::string name = key.substr(0, key.find('='));
    check_refused(folder, {name.c_str(), bih(key), name + " is not read by this design; expected it only when rtu.core = svo"});
  }
  for (const std::string key : {"quantisation.n=20", "quantisation.division_drop=1", "bih_core.early_out=true", "bih_core.rays_in_flight=3",
                                "bih_builder.leaf_triangles=4", "triangle_unit.t_halved=true", "t_div.kind=iterative", "driver.norm=one",
                                "driver.skip_misses=false"}) {
    const std::string name = key.substr(0, key.find('='));
    check_refused(folder,
                  {name.c_str(), small_run({"--set", key}), name + " is not read by this design; expected it only when rtu.core = bih"});
  }
  struct range {
    const char* key;
    int least, most;
  };
  const range ranges[] = {{"quantisation.n", 4, 32},
                          {"quantisation.m", 4, 34},
                          {"quantisation.edge_shift", 0, 20},
                          {"quantisation.reciprocal_bits", 0, 28},
                          {"bih_core.address_bits", 6, 18},
                          {"bih_core.rays_in_flight", 1, 64},
                          {"bih_builder.leaf_triangles", 1, 4096}};
  for (const range& r : ranges)
    for (const int value : {r.least - 1, r.most + 1}) {
      const std::string found = std::string(r.key) + " = " + std::to_string(value);
      const std::string text = found + "; expected a whole number from " + std::to_string(r.least) + " to " + std::to_string(r.most);
      check_refused(folder, {r.key, bih(std::string(r.key) + '=' + std::to_string(value)), text});
    }
  words dropped = bih("quantisation.n=8");
  dropped.insert(dropped.end(), {"--set", "quantisation.division_drop=8"});
  const refusal all[] = {
      {"more bits dropped than there are", dropped, "quantisation.division_drop: 8; expected at most n - 1 = 7"},
      {"a divider's width in a whole unit", bih("t_div.width=32"), "t_div.width is not read by this design"},
      {"a divider of no kind", bih("t_div.kind=serial"), "t_div.kind = \"serial\"; expected pipelined or iterative"},
      {"a norm that is none", bih("driver.norm=three"), "driver.norm = \"three\"; expected one or two"},
      {"a core that is none", bih("rtu.core=bvh"), "rtu.core = \"bvh\"; expected svo or bih; did you mean bih?"},
      {"a core of octrees for a mesh's key", bih("rtu.core=svo"), "a design of bih cores; expected --arch with one of svo cores"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  // The ends of the ranges are good for a run.
  for (const words& ends : {words{"quantisation.n=32", "quantisation.m=34", "quantisation.edge_shift=20", "quantisation.reciprocal_bits=28",
                                  "t_div.kind=iterative", "bih_core.address_bits=18", "bih_core.rays_in_flight=64",
                                  "bih_builder.leaf_triangles=4096", "quantisation.division_drop=24"},
                            words{"quantisation.n=4", "quantisation.m=4", "quantisation.edge_shift=0", "quantisation.reciprocal_bits=0",
                                  "bih_core.rays_in_flight=1", "bih_builder.leaf_triangles=1", "quantisation.division_drop=3"}}) {
    words run = bih("frame.width=12");
    for (const std::string& end : ends) run.insert(run.end(), {"--set", end});
    run.insert(run.end(), {"--set", "frame.height=8", "--pace", "checked"});
    const outcome o = rtusim(folder, run);
    CAPTURE(o.err);
    CHECK(o.status == 0);
  }
}

TEST_CASE("command line: an output that can't be written is refused before the run, a full disk leaves nothing", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("log.csv", "of an earlier run\n");
  std::filesystem::create_directory(folder / "folder");
  std::filesystem::create_symlink("/dev/full", folder / "full.png");
  std::filesystem::create_symlink("/dev/full", folder / "full.exr");
  folder.file("in.csv", "id,a,addr,t0x,t0y,t0z,t1x,t1y,t1z\n0,0,0,0,0,0,1,1,1\n");
  std::vector<refusal> all{
      {"a picture of no format", small_run({"--image", "out.jpg"}), "out.jpg: no picture format that we write"},
      {"a picture of no kind", small_run({"--image", "out.cots.png"}), "out.cots.png: unknown kind of picture \"cots\""},
      {"a picture without a name", small_run({"--image", ".png"}), ".png: no picture format"},
      {"one file for two outputs", small_run({"--log", "out", "--stats", "./out"}), "out: the file of the output ./out, too"},
      {"a unit's folder", {"unit", "float_to_fixed", "--jobs", "in.csv", "--out", "none/out"}, "none/out: its folder does not exist"},
      {"a picture on a full device", small_run({"--image", "full.png"}), "full.png: "},
      {"layers on a full device", small_run({"--image", "full.exr"}), "full.exr: "},
      {"a waveform on a full device", small_run({"--vcd", "/dev/full"}), "/dev/full: No space left"},
      {"a model's picture on a full device", {"info", dragon, "--image", "full.png"}, "full.png: "},
      {"a model's picture on a full disk", {"info", dragon, "--image", "out.png"}, "out.png: ", 2, 100},
      {"a full device for a table", {"unit", "svo_core", "--jobs", "in.csv", "--out", "/dev/full", "--model", dragon}, "/dev/full: No"},
  };
  for (const char* option : {"--log", "--stats", "--save-jobs"})
    all.push_back({"a full device", small_run({option, "/dev/full"}), "/dev/full: No space left"});
  const std::pair<const char*, const char*> outputs[] = {{"--log", "log.csv"},   {"--stats", "out.json"}, {"--save-jobs", "out.bin"},
                                                         {"--image", "out.png"}, {"--image", "out.exr"},  {"--vcd", "out.vcd"}};
  for (const auto& [option, name] : outputs) {
    const std::string missing = std::string("none/") + name;
    const words other{std::string(option) == "--log" ? "--stats" : "--log", "other"};
    all.push_back({"an output in no folder", small_run({other[0], other[1], option, missing}), missing + ": its folder does not exist"});
    all.push_back({"a disk that gets full", small_run({option, name}), name, 2, 100});
  }
  all.push_back({"a folder for an output", small_run({"--log", "folder"}), "folder: a folder"});
  for (const refusal& r : all) check_refused(folder, r);
}

TEST_CASE("command line: a waveform's window must lie in the run", "[testbench]") {
  const test::scratch_folder folder;
  const auto vcd = [](words also) {
    also.insert(also.end(), {"--vcd", "out.vcd"});
    return small_run(also);
  };
  const refusal all[] = {
      {"no waveform", small_run({"--vcd-from", "3"}), "no --vcd"},
      {"a window that ends before it begins", vcd({"--vcd-from", "9", "--vcd-to", "8"}), "--vcd-to: 8, before --vcd-from 9"},
      {"a window after the run", vcd({"--vcd-from", "1000000"}), "--vcd-from: cycle 1000000, and the run ends with cycle"},
      {"the last cycle there is", vcd({"--vcd-from", "18446744073709551615"}), "and the run ends with cycle"},
      {"fewer than zero cycles", vcd({"--vcd-from", "-3"}), "--vcd-from: \"-3\"; expected a whole number"},
      {"more cycles than a word holds", vcd({"--vcd-to", "18446744073709551616"}), "--vcd-to: \"18446744073709551616\""},
      {"no number", vcd({"--vcd-to", "1e3"}), "--vcd-to: \"1e3\"; expected a whole number"},
      {"a job that never comes", vcd({"--vcd-job", "144"}), "--vcd-job: 144, which no job has"},
      {"a job and a cycle", vcd({"--vcd-job", "1", "--vcd-from", "0"}), "--vcd-job: with --vcd-from or --vcd-to"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  CHECK(rtusim(folder, vcd({"--vcd-from", "20", "--vcd-to", "18446744073709551615"})).status == 0);
  CHECK(contents(folder).count("out.vcd") == 1);
}

TEST_CASE("command line: the watchdog ends a run whose sink is never ready, and nothing is left", "[testbench]") {
  const test::scratch_folder folder;
  for (const char* pace : {"skipping", "stepped", "checked"}) {
    const words blocked = small_run({"--set", "sink.ready=never", "--set", "watchdog.cycles=1000", "--set", "rtu.cores=2", "--pace", pace,
                                     "--log", "log.csv", "--stats", "out.json", "--image", "out.png", "--vcd", "out.vcd"});
    check_refused(folder, {pace, blocked, "no transfer in the 1000 cycles after cycle ", 1});
    const std::string chain = rtusim(folder, blocked).err;
    for (const char* link : {"core_0 waits for result_manager", "core_1 waits for result_manager", "result_manager waits for sink"})
      CHECK_THAT(chain, Catch::Contains(link));
  }
}

TEST_CASE("command line: raw words are taken whatever they hold", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("nan.bin", std::string(32, '\xff') + std::string(32, '\x7f') + std::string(32, '\0'));
  const outcome o = rtusim(folder, small_run({"--jobs", "nan.bin", "--log", "log.csv"}));
  CHECK(o.status == 0);
  CHECK_THAT(o.err, Catch::StartsWith("rtusim: warning: "));
  CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
  const std::string log = contents(folder).at("log.csv");
  CHECK(std::count(log.begin(), log.end(), '\n') == 4);

  const outcome triangles = rtusim(folder, {"run", "--quiet", "--arch", source + "testbench/architectures/hanika2007.toml", "--model",
                                            teapot, "--jobs", "nan.bin", "--pace", "checked", "--log", "log.csv"});
  CHECK(triangles.status == 0);
  CHECK(triangles.err == "rtusim: warning: 6 parameters of the jobs lie beyond the fixed-point range, 6 are no number\n");
  CHECK_THAT(contents(folder).at("log.csv"), Catch::StartsWith("cycle,core,job_id,hit,tri,t,u,v,clocks\n"));

  folder.file("wide.csv",
              "id,a,addr,t0x,t0y,t0z,t1x,t1y,t1z,note\n"
              "0,7,4294967295,9223372036854775807,-9223372036854775808,0,0,0,0,x\n");
  const outcome unit = rtusim(folder, {"unit", "svo_core", "--jobs", "wide.csv", "--out", "out.csv", "--model", dragon});
  CHECK(unit.status == 0);
  CHECK_THAT(unit.err, Catch::StartsWith("rtusim: warning: 2 words are wider than "));
  CHECK_THAT(contents(folder).at("out.csv"), Catch::Contains("raw_normal_axis,note\n") && Catch::EndsWith(",x\n"));

  folder.file("wide.csv", "n,note,d\n9223372036854775807,x,-1\n4294967296,y,4294967297\n");
  const outcome divisions = rtusim(folder, {"unit", "t_div", "--jobs", "wide.csv", "--out", "out.csv"});
  CHECK(divisions.status == 0);
  CHECK(divisions.err == "rtusim: warning: 3 words are wider than their registers and were cut\n");
  folder.file("wide.csv", "n,d\n-9223372036854775808,-1\n1,-2\n");
  CHECK(rtusim(folder, {"unit", "t_div", "--jobs", "wide.csv", "--out", "out.csv", "--set", "t_div.width=64"}).err.empty());
  CHECK_THAT(contents(folder).at("out.csv"), Catch::EndsWith("\n1,-2,11529215046068469760,1\n"));  // 2^63 + 2^61
}

TEST_CASE("command line: a run and the units give the golden files", "[testbench]") {
  const test::scratch_folder folder;
  const words run{"run", "--arch", as_built, "--model", dragon, "--jobs", golden + "sys/jobs_64x36_literal.bin.gz", "--log", "log.csv"};
  const outcome o = rtusim(folder, run);
  CHECK(o.status == 0);
  CHECK(o.err.empty());
  CHECK_THAT(o.out, Catch::Contains("2304 rays"));
  CHECK((contents(folder)["log.csv"] == config::read_file(golden + "sys/log_64x36_literal_ideal_c16.csv.gz")));

  for (const std::string name : {"dragon_32", "rand_16_far"}) {
    const std::string table = golden + "core/core_" + name + ".csv.gz";
    const std::string model = golden + "models/" + name + ".svo";
    const words unit{"unit", "svo_core", "--arch", as_built, "--model", model, "--jobs", table, "--out", "out"};
    CHECK(rtusim(folder, unit).status == 0);
    CHECK((contents(folder)["out"] == config::read_file(table)));
  }
  const std::string triangles = source + "testbench/golden/bih/";
  const std::pair<std::string, words> triangle_units[] = {
      {"tdiv_w16", {"t_div", "--set", "t_div.width=16"}},
      {"tdiv_w32", {"t_div", "--set", "t_div.width=32"}},
      {"tdiv_w16", {"t_div", "--set", "t_div.width=16", "--set", "t_div.kind=iterative"}},
      {"tri_int_n30_m32", {"triangle_unit", "--set", "errata.all=true"}}};
  for (const auto& [name, unit] : triangle_units) {
    const std::string file = triangles + name + ".csv.gz";
    words arguments{"unit", "--jobs", file, "--out", "out"};
    arguments.insert(arguments.end(), unit.begin(), unit.end());
    const outcome triangle_unit = rtusim(folder, arguments);
    CHECK(triangle_unit.status == 0);
    CHECK(triangle_unit.err.empty());
    CHECK((contents(folder)["out"] == config::read_file(file)));
  }
  const std::string table = golden + "float_to_fixed.csv.gz";
  CHECK(rtusim(folder, {"unit", "float_to_fixed", "--arch", as_built, "--jobs", table, "--out", "out"}).status == 0);
  CHECK((contents(folder)["out"] == config::read_file(table)));
}

TEST_CASE("command line: the hierarchy's core gives the golden files", "[testbench]") {
  const test::scratch_folder folder;
  const std::string bih = RTUSIM_SOURCE_DIR "/testbench/golden/bih/";
  struct row {
    const char* table;
    const char* scene;
  };
  const row rows[] = {{"bih_tetra_k1_400", "tetra_k1"},
                      {"bih_cube_k2_400", "cube_k2"},
                      {"bih_cubepot_k4_400", "cubepot_k4"},
                      {"frame_cubepot_k8_64x48_m1", "cubepot_k8"}};
  for (const row& r : rows) {
    const std::string table = bih + r.table + ".csv.gz";
    const outcome o = rtusim(folder, {"unit", "bih_core", "--set", "errata.all=true", "--set", "bih_core.address_bits=10", "--memory",
                                      bih + "scenes/" + r.scene, "--jobs", table, "--out", "out"});
    CHECK(o.status == 0);
    CHECK(o.err.empty());
    CHECK((contents(folder)["out"] == config::read_file(table)));
  }
  const outcome o =
      rtusim(folder, {"unit", "bih_core", "--memory", bih + "scenes/tetra_k1", "--jobs", bih + "bih_tetra_k1_400.csv.gz", "--out", "out"});
  CHECK(o.status == 2);
  CHECK_THAT(o.err, Catch::Contains("1024 lines; expected 65536, one for each of 16 address bits"));
}

TEST_CASE("command line: two runs give the same bytes, and so does one from the jobs that the first one kept", "[testbench]") {
  const words outputs{"--log",       "a.csv",   "--image", "a.png", "--image", "a.cost.png", "--image",
                      "a.depth.png", "--image", "a.exr",   "--vcd", "a.vcd",   "--vcd-job",  "70"};
  words first = small_run(outputs);
  first.insert(first.end(), {"--save-jobs", "a.bin"});
  const test::scratch_folder folder, again, from_jobs;
  for (const auto* where : {&folder, &again}) {
    const outcome o = rtusim(*where, first);
    CHECK(o.status == 0);
    CHECK(o.out.empty());
    CHECK(o.err.empty());
  }
  auto files = contents(folder);
  CHECK(files.size() == 7);
  CHECK((files == contents(again)));

  words later = small_run(outputs);
  later.insert(later.end(), {"--jobs", (folder / "a.bin").string()});
  CHECK(rtusim(from_jobs, later).status == 0);
  files.erase("a.bin");
  CHECK((files == contents(from_jobs)));
}

TEST_CASE("command line: an octree takes the place of a scene's mesh", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("scene.toml", "[scene]\nmodel = \"none.ply\"\nresolution = 64\n[frame]\nwidth = 16\nheight = 9\n");
  const outcome o = rtusim(folder, {"run", "scene.toml", "--model", dragon, "--stats", "out.json"});
  CHECK(o.status == 0);
  CHECK_THAT(o.out, Catch::Contains("144 rays"));
  CHECK_THAT(contents(folder).at("out.json"), !Catch::Contains("resolution"));
}

TEST_CASE("command line: a file in place of another is told as what it is", "[testbench]") {
  const test::scratch_folder folder;
  folder.file("binary.toml", std::string("a = 1\n\0", 7));
  const refusal all[] = {
      {"a mesh for a scene", {"run", teapot}, "teapot.bpt: a model; expected a scene file (TOML); --model FILE is for models"},
      {"an octree for a scene", {"run", dragon}, "dragon_32.svo: a model; expected a scene file (TOML); --model FILE is for models"},
      {"a zipped mesh in capitals", {"run", "A.PLY.GZ"}, "A.PLY.GZ: a model; expected a scene file"},
      {"a model for a design", small_run({"--arch", "a.glb"}), "a.glb: a model; expected an architecture file (TOML)"},
      {"no text", {"run", "binary.toml"}, "binary.toml: a binary file; expected a TOML file"},
      {"a design of other cores", small_run({"--arch", as_built, "--set", "rtu.core=bih"}),
       "--set: rtu.core = bih for " + as_built + ", a design of svo cores; expected --arch with one of bih cores"},
      {"a design of other cores, the other way",
       small_run({"--arch", source + "testbench/architectures/hanika2007.toml", "--set", "rtu.core=svo"}),
       "hanika2007.toml, a design of bih cores; expected --arch with one of svo cores"},
  };
  for (const refusal& r : all) check_refused(folder, r);
  // What the design does not read otherwise is told by its own name.
  check_refused(folder,
                {"a value", small_run({"--arch", as_built, "--set", "bih_core.address_bits=9"}), "bih_core.address_bits is not read"});
}

TEST_CASE("command line: a run tells which design it took if none was named", "[testbench]") {
  const test::scratch_folder folder;
  const words run{"run", "--model", dragon, "--set", "frame.width=16", "--set", "frame.height=9"};
  CHECK_THAT(rtusim(folder, run).out, Catch::Contains("\nno --arch: the default design (testbench/architectures/espe2019.toml)"));
  words with_design = run;
  for (const std::string& word : {std::string("--arch"), source + "testbench/architectures/espe2019.toml"}) with_design.push_back(word);
  const outcome o = rtusim(folder, with_design);
  CHECK(o.status == 0);
  CHECK_THAT(o.out, !Catch::Contains("--arch"));
}

TEST_CASE("command line: it explains itself", "[testbench]") {
  const test::scratch_folder folder;
  const std::pair<words, const char*> asked[] = {
      {{"--help"}, "explain"},
      {{"run", "--help"}, "--set KEY=VALUE"},
      {{"explain"}, "scheduler.policy"},
      {{"explain", "sink.ready"}, "always, lfsr"},
      {{"explain", "statistics.rays"}, "statistics.rays"},
      {{"explain", "latency"}, "statistics.latency.mean"},
      {{"explain", "bih"}, "bih_core.address_bits"},
      {{"explain", "bih"}, "\nFigures of the statistics file:\n\nstatistics.bih_core."},
      {{"info", dragon}, "octree of 5 levels: 32 voxels an edge"},
      {{"info", source + "scenes/data/dragon_res4.ply"}, "triangles"},
      {{"convert", "--help"}, "--resolution N"},
  };
  for (const auto& [arguments, text] : asked) {
    const outcome o = rtusim(folder, arguments);
    CHECK(o.status == 0);
    CHECK(o.err.empty());
    CHECK_THAT(o.out, Catch::Contains(text));
  }
  CHECK(folder.empty());
}

TEST_CASE("command line: a mesh is converted, described, looked at and traced", "[testbench]") {
  const test::scratch_folder folder;
  const std::string bunny = source + "scenes/data/bunny.obj";
  const std::pair<words, const char*> asked[] = {
      {{"convert", bunny, "bunny.svo", "--resolution", "32", "--solid", "--up", "-z", "--margin", "2", "--fit", "0.9"},
       "32 voxels an edge"},
      {{"convert", "bunny.svo", "bunny.binvox"}, "32 voxels an edge"},
      {{"info", "bunny.binvox", "--image", "bunny.png"}, "as an octree of 5 levels"},
      {{"run", "--model", "bunny.binvox", "--set", "frame.width=16", "--set", "frame.height=9", "--image", "frame.png"}, "144 rays"},
      {{"info", bunny, "--image", "mesh.png"}, "           0 open edges"},
  };
  for (const auto& [arguments, text] : asked) {
    const outcome o = rtusim(folder, arguments);
    CHECK(o.status == 0);
    CHECK(o.err.empty());
    CHECK_THAT(o.out, Catch::Contains(text));
  }
  CHECK(rtusim(folder, {"convert", "bunny.binvox", "again.svo", "--quiet"}).out.empty());
  const auto files = contents(folder);
  CHECK(files.size() == 6);
  CHECK((files.at("bunny.svo") == files.at("again.svo")));
  for (const char* name : {"bunny.png", "mesh.png"}) CHECK_THAT(files.at(name), Catch::StartsWith("\x89PNG"));
  // Each option makes another model.
  const words plain{"convert", bunny, "out.svo", "--resolution", "16", "--quiet"};
  std::set<std::string> models;
  const std::vector<words> options{{}, {"--solid"}, {"--up", "z"}, {"--margin", "2"}, {"--fit", "0.5"}, {"--resolution", "32"}};
  for (const words& more : options) {
    words all = plain;
    if (!more.empty() && more[0] == "--resolution") all.erase(all.begin() + 3, all.begin() + 5);
    all.insert(all.end(), more.begin(), more.end());
    CHECK(rtusim(folder, all).status == 0);
    models.insert(bytes_of(folder / "out.svo"));
  }
  CHECK(models.size() == options.size());

  const test::scratch_folder empty;
  const words convert{"convert", bunny, "out.svo", "--resolution", "32"};
  const auto with = [&](const words& also) {
    words all = convert;
    all.insert(all.end(), also.begin(), also.end());
    return all;
  };
  const refusal all[] = {
      {"no output", {"convert", bunny}, "convert: TO is required"},
      {"no resolution", {"convert", bunny, "out.svo"}, "convert: no --resolution; expected a power of two"},
      {"fewer than no voxels", {"convert", bunny, "out.svo", "--resolution", "-32"}, "--resolution: \"-32\"; expected a whole number"},
      {"a fit that is none", with({"--fit", "tight"}), "--fit: \"tight\"; expected a number above 0"},
      {"a mesh with holes to be filled",
       {"convert", source + "scenes/data/teapot.bpt", "out.svo", "--resolution", "32", "--solid"},
       "160 open edges, the first from (1.4, 2.4, 0)"},
      {"a full disk", with({}), "out.svo: ", 2, 100},
      {"a full disk for a picture", {"info", bunny, "--image", "out.png"}, "out.png: ", 2, 100},
      {"a picture of no format", {"info", bunny, "--image", "out.jpg"}, "out.jpg: no picture format"},
      {"a folder that is not there", {"info", bunny, "--image", "none/out.png"}, "none/out.png: its folder does not exist"},
  };
  for (const refusal& r : all) check_refused(empty, r);
}

}  // namespace
}  // namespace rtusim
