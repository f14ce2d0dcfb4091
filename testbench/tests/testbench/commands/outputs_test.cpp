#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

/// Where the program's outputs may go, and where not.
namespace rtusim {
namespace {

namespace fs = std::filesystem;
using Catch::Contains;
using test::bytes_of;
using test::outcome;

const std::string source = RTUSIM_SOURCE_DIR "/";
const std::string dragon = source + "testbench/golden/svo/models/dragon_32.svo";
const std::string log_header = "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n";

/// Runs a line of the shell in a folder; `$R` is the program, `$RUN` a small run of it.
outcome shell(const test::scratch_folder& folder, const std::string& line) {
  const test::scratch_folder told;
  const std::string whole = fmt::format(
      "cd {} && R={} && RUN=\"$R run --model model.svo --set frame.width=16 --set frame.height=9\" && {{ {}\n}} >{} 2>{} </dev/null",
      (folder / "").string(), RTUSIM_BINARY, line, (told / "out").string(), (told / "err").string());
  const int status = std::system(whole.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytes_of(told / "out"), bytes_of(told / "err")};
}

/// A folder with a model, a scene, a design, rays, jobs, and a glTF with a buffer.
struct inputs_folder : test::scratch_folder {
  inputs_folder() {
    fs::copy(dragon, *this / "model.svo");
    fs::copy(source + "testbench/architectures/espe2019.toml", *this / "arch.toml");
    file("scene.toml", "[scene]\nmodel = \"model.svo\"\n[frame]\nwidth = 16\nheight = 9\n");
    file("rays.csv", "ox,oy,oz,dx,dy,dz\n0,0,3,0,0,-1\n");
    file("cube.obj", bytes_of(source + "testbench/tests/cases/mesh_cube.obj"));
    file("words.csv", "id,float_bits\n0,0\n");
    file("tri.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
                     R"({"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"tri.bin","byteLength":36}],"bufferViews":[{"buffer":0,)"
                     R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],)"
                     R"("max":[1,1,0]}]})");
    std::string corners(36, '\0');
    corners.replace(14, 2, "\x80\x3f");
    corners.replace(30, 2, "\x80\x3f");
    file("tri.bin", corners);
    REQUIRE(shell(*this, "$RUN --quiet --save-jobs jobs.bin --stats stats.json").status == 0);
    fs::create_symlink("model.svo", *this / "link.svo");
    fs::create_hard_link(*this / "model.svo", *this / "twin.svo");
  }
};

}  // namespace

TEST_CASE("outputs: an input is never overwritten, by whatever name", "[outputs]") {
  const inputs_folder folder;
  const struct {
    const char* line;
    const char* told;
  } refused[] = {
      {"$R run scene.toml --stats scene.toml", "scene.toml: the file of the input scene.toml"},
      {"$RUN --log model.svo", "model.svo: the file of the input model.svo"},
      {"$RUN --save-jobs link.svo", "link.svo: the file of the input model.svo"},
      {"$RUN --vcd twin.svo", "twin.svo: the file of the input model.svo"},
      {"$R run --model twin.svo --log ./model.svo", "./model.svo: the file of the input twin.svo"},
      {"$R run scene.toml --log model.svo", "model.svo: the file of the input model.svo"},
      {"$RUN --arch arch.toml --log $PWD/arch.toml", "arch.toml: the file of the input arch.toml"},
      {"$RUN --jobs jobs.bin --save-jobs jobs.bin", "jobs.bin: the file of the input jobs.bin"},
      {"$RUN --set scene.rays=rays.csv --log rays.csv", "rays.csv: the file of the input rays.csv"},
      {"$R run --model tri.gltf --set scene.resolution=8 --log tri.bin", "tri.bin: the file of the input "},
      {"$R convert tri.gltf tri.gltf.svo --resolution 8 && ln tri.bin bin.svo && $R convert tri.gltf bin.svo --resolution 8 --quiet",
       "bin.svo: the file of the input "},
      {"$R convert model.svo link.svo", "link.svo: the file of the input model.svo"},
      {"ln -s model.svo m.binvox; $R convert model.svo m.binvox", "m.binvox: the file of the input model.svo"},
      {"ln -s ../$(basename $PWD)/model.svo v.png; $R info model.svo --image v.png", "v.png: the file of the input model.svo"},
      {"ln tri.bin b.png; $R info tri.gltf --image b.png", "b.png: the file of the input "},
      {"$R unit float_to_fixed --jobs words.csv --out words.csv", "words.csv: the file of the input words.csv"},
      {"$R rerun stats.json --stats ./stats.json", "./stats.json: the file of the input stats.json"},
      {"$R rerun stats.json --stats model.svo", "model.svo: the file of the input model.svo"},
      {"$RUN --log x --stats $PWD/x", "x: the file of the output "},
      {"$RUN --log - --stats /dev/stdout", "-: the file of the output /dev/stdout, too; expected at most one output there"},
      {"$RUN --stats s.json --log - >s.json", "-: the file of the output s.json, too"},
  };
  const auto bytes = [&folder] {
    std::string all;
    for (const char* name : {"scene.toml", "model.svo", "arch.toml", "jobs.bin", "rays.csv", "tri.bin", "words.csv"})
      all += bytes_of(folder / name);
    return all;
  };
  const std::string before = bytes();
  for (const auto& r : refused) {
    CAPTURE(r.line);
    const outcome o = shell(folder, r.line);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, Contains(r.told));
    CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
    CHECK(bytes() == before);
  }
  for (const auto& entry : fs::directory_iterator(folder / "")) CHECK(entry.path().filename().string().front() != '.');
}

TEST_CASE("outputs: standard output is appended to, and the summary goes beside it", "[outputs]") {
  const inputs_folder folder;
  REQUIRE(shell(folder, "$RUN --quiet --log log.csv").status == 0);
  const std::string log = bytes_of(folder / "log.csv");
  REQUIRE(log.rfind(log_header, 0) == 0);
  for (const char* name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"}) {
    CAPTURE(name);
    const outcome o = shell(folder, fmt::format("$RUN --log {}", name));
    CHECK(o.status == 0);
    CHECK(o.out == log);
    CHECK_THAT(o.err, Contains("cycles a ray"));
    folder.file("all.csv", "before\n");
    REQUIRE(shell(folder, fmt::format("$RUN --log {} >>all.csv", name)).status == 0);
    CHECK(bytes_of(folder / "all.csv") == "before\n" + log);
  }
  CHECK(!fs::exists(folder / "-"));
  CHECK(shell(folder, "{ echo first; $RUN --quiet --log -; echo last; } >all.csv").status == 0);
  CHECK(bytes_of(folder / "all.csv") == "first\n" + log + "last\n");
  CHECK(shell(folder, "$RUN --quiet --save-jobs - | cmp - jobs.bin").status == 0);
  CHECK(shell(folder, "$RUN --quiet --vcd w.vcd && $RUN --quiet --vcd - | cmp - w.vcd").status == 0);
  CHECK(shell(folder, "$R unit float_to_fixed --jobs words.csv --out -").out == "id,float_bits,fixed_raw\n0,0,0\n");
  CHECK(shell(folder, "$RUN").err.empty());
  const outcome picture = shell(folder, "$RUN --image -");
  CHECK(picture.status == 2);
  CHECK_THAT(picture.err, Contains("-: no picture format that we write; expected NAME.png"));
}

TEST_CASE("outputs: a pipe that nobody reads ends the program without a word, standard output that is full or closed is told",
          "[outputs]") {
  const inputs_folder folder;
  const outcome quiet = shell(folder, "{ sleep 0.2; $R explain; echo $? >&2; } | true; { sleep 0.2; $RUN --log -; echo $? >&2; } | true");
  CHECK(quiet.err == "141\n141\n");
  const outcome ignored = shell(folder, "(trap '' PIPE; { $R explain; echo $? >&2; } | true)");
  if (!ignored.err.empty()) CHECK_THAT(ignored.err, Contains("Broken pipe") || Catch::Equals("0\n"));
  const struct {
    const char* line;
    const char* told;
  } failing[] = {
      {"$RUN >/dev/full", "No space left on device"}, {"$RUN >&-", "Bad file descriptor"},
      {"$R explain >&-", "Bad file descriptor"},      {"$R --help >/dev/full", "No space left"},
      {"$RUN --log - >&-", "Bad file descriptor"},    {"$RUN --log - >/dev/full", "No space left"},
  };
  for (const auto& f : failing) {
    CAPTURE(f.line);
    const outcome o = shell(folder, f.line);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, Catch::StartsWith("rtusim: ") && Contains(f.told));
    CHECK(std::count(o.err.begin(), o.err.end(), '\n') == 1);
  }
  const std::string before = bytes_of(folder / "model.svo");
  for (const char* closed : {"<&- >&- 2>&-", "<&- 2>&-", "2>&-", "<&-"}) {
    CAPTURE(closed);
    CHECK(shell(folder, fmt::format("$RUN --quiet --log log.csv --image p.png --vcd w.vcd {}", closed)).status == 0);
    CHECK(bytes_of(folder / "log.csv").rfind(log_header, 0) == 0);
    CHECK(bytes_of(folder / "p.png").rfind("\x89PNG", 0) == 0);
    CHECK(bytes_of(folder / "w.vcd").rfind("$version", 0) == 0);
    CHECK(shell(folder, fmt::format("$R convert cube.obj c.svo --resolution 8 --quiet {}", closed)).status == 0);
    CHECK(shell(folder, fmt::format("$RUN --quiet --model none.obj {}", closed)).status == 2);
  }
  CHECK(bytes_of(folder / "model.svo") == before);
}

TEST_CASE("outputs: a program without a standard input writes its files all the same", "[outputs]") {
  const inputs_folder folder;
  CHECK(shell(folder, "$RUN --quiet --stats s.json --log l.csv <&-").status == 0);
  for (const char* name : {"s.json", "l.csv"}) CHECK(fs::file_size(folder / name) > 100);
}

TEST_CASE("outputs: a file keeps its mode, and a link that leads nowhere gets its file", "[outputs]") {
  const inputs_folder folder;
  REQUIRE(shell(folder, "touch s.json && chmod 600 s.json && ln -s made.csv dangling.csv && $RUN --quiet --stats s.json --log dangling.csv")
              .status == 0);
  struct stat found {};
  REQUIRE(::stat((folder / "s.json").c_str(), &found) == 0);
  CHECK((found.st_mode & 0777) == 0600);
  CHECK(found.st_size > 100);
  CHECK(fs::is_symlink(folder / "dangling.csv"));
  CHECK(bytes_of(folder / "made.csv").rfind(log_header, 0) == 0);
}

TEST_CASE("outputs: names of files reach the terminal without control characters", "[outputs]") {
  const inputs_folder folder;
  const std::string name = "$(printf 'a\\033[31m\\302\\233\\377\\n.svo')";
  REQUIRE(shell(folder, fmt::format("cp model.svo \"{}\"", name)).status == 0);
  const std::string lines[] = {
      fmt::format("$R run --model \"{}\" --set frame.width=16 --set frame.height=9 --stats s.json", name),
      fmt::format("$R run --model \"none{}\"", name),
      fmt::format("$R run --model \"{}\" --set frame.width=16 --set frame.height=9 --stats t.json --quiet && $R diff stats.json t.json",
                  name),
      fmt::format("$R info \"none{}\"", name),
      fmt::format("$R \"{}\"", name),
  };
  for (const std::string& line : lines) {
    CAPTURE(line);
    const outcome o = shell(folder, line);
    CHECK_THAT(o.out + o.err,
               Contains("a?[31m????.svo") || Contains("a?[31m??\ufffd?.svo"));  // a record has what UTF-8 has for broken bytes
    const auto is_raw = [](char c) { return (c >= '\0' && c < ' ' && c != '\n') || c == '\x7f' || c == '\x9b' || c == '\xff'; };
    CHECK(std::none_of(o.out.begin(), o.out.end(), is_raw));
    CHECK(std::none_of(o.err.begin(), o.err.end(), is_raw));
  }
}

TEST_CASE("outputs: a waveform of a whole frame is refused with its size, unless it is asked for", "[outputs]") {
  const inputs_folder folder;
  const std::string whole = "$R run --model model.svo --set frame.width=1920 --set frame.height=1080 --quiet";
  for (const char* also :
       {"--vcd w.vcd", "--vcd w.vcd --vcd-from 1000", "--vcd w.vcd --vcd-to 99000000", "--vcd w.vcd --set rtu.cores=64"}) {
    CAPTURE(also);
    const outcome o = shell(folder, fmt::format("{} {}", whole, also));
    CHECK(o.status == 2);
    CHECK_THAT(o.err, Contains("w.vcd: a waveform of about ") &&
                          Contains(" GB; expected a window (--vcd-from and --vcd-to, or --vcd-job), or --vcd-all"));
    CHECK(!fs::exists(folder / "w.vcd"));
  }
  for (const char* also : {"--vcd w.vcd --vcd-from 10 --vcd-to 100", "--vcd w.vcd --vcd-job 1000000"}) {
    CAPTURE(also);
    CHECK(shell(folder, fmt::format("{} {}", whole, also)).status == 0);
    CHECK(fs::file_size(folder / "w.vcd") < 1'000'000);
  }
  CHECK(shell(folder, "$RUN --quiet --vcd w.vcd --vcd-all").status == 0);
  CHECK_THAT(shell(folder, "$RUN --quiet --vcd-all").err, Contains("no --vcd"));
  test::limits some;
  some.most_bytes = 1'000'000;  // in place of a disk
  const outcome begun = test::rtusim(
      folder, {"run", "scene.toml", "--set", "frame.width=1920", "--set", "frame.height=1080", "--vcd", "w.vcd", "--vcd-all"}, some);
  CHECK(begun.status == 2);
  CHECK_THAT(begun.err, Contains("w.vcd: File too large"));
}

#ifndef __SANITIZE_ADDRESS__  // which takes terabytes of addresses
TEST_CASE("outputs: a lack of memory is called so, whoever meets it", "[outputs]") {
  const inputs_folder folder;
  const test::words commands[] = {
      {"convert", source + "scenes/data/bunny.obj", "b.svo", "--resolution", "1024", "--solid"},
      {"run", "scene.toml", "--set", "frame.width=16384", "--set", "frame.height=16384", "--image", "p.png"},
      {"run", "scene.toml", "--image", "p.sheet.png", "--set", "frame.width=640", "--set", "frame.height=360"},
  };
  for (const test::words& c : commands)
    for (const rlim_t megabytes : {60, 90, 130, 190}) {
      CAPTURE(c, megabytes);
      test::limits little;
      little.most_memory = megabytes << 20;
      const outcome o = test::rtusim(folder, c, little);
      if (o.status == 0) continue;
      CHECK(o.status == 2);
      CHECK(o.err == "rtusim: out of memory\n");
    }
}
#endif

}  // namespace rtusim
