#include <catch2/catch.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"

// The source that each build writes for `rtusim --version`.
namespace rtusim {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;

bool ran(const std::string& command) { return std::system(command.c_str()) == 0; }

/// What `program_version` would return in a build of this tree.
std::string version_of(const fs::path& tree, const fs::path& made) {
  REQUIRE(ran(fmt::format("'{}' '-DROOT={}' -DVERSION=1.2.3 '-DOUTPUT={}' -P '{}'", RTUSIM_CMAKE, tree.string(), made.string(),
                          RTUSIM_SOURCE_DIR "/testbench/run/program_version.cmake")));
  const std::string text = bytes_of(made), before = "return \"";
  const std::size_t begin = text.find(before) + before.size();
  return text.substr(begin, text.find('"', begin) - begin);
}

TEST_CASE("program version: the commit and whether the tree differs, rewritten only if it changed", "[testbench]") {
  const test::scratch_folder folder;
  const fs::path tree = folder / "tree", made = folder / "made.cpp";
  fs::create_directories(tree / "copy");
  CHECK(version_of(tree, made) == "1.2.3 (unknown)");
  if (!ran("git --version >'" + (folder / "git.txt").string() + "' 2>&1")) return;

  const auto git = [&](const std::string& arguments) {
    return ran(fmt::format("git -C '{}' -c user.name=n -c user.email=e -c commit.gpgsign=false {} >'{}' 2>&1", tree.string(), arguments,
                           (folder / "git.txt").string()));
  };
  REQUIRE(git("init"));
  CHECK(version_of(tree, made) == "1.2.3 (unknown)");
  folder.file("tree/a.h", "1");
  REQUIRE((git("add a.h") && git("commit -m 1")));
  const std::string version = version_of(tree, made);
  CHECK_THAT(version, Catch::Matches(R"(1\.2\.3 \([0-9a-f]{7,40}\))"));

  const auto old = fs::last_write_time(made) - std::chrono::hours(1);
  fs::last_write_time(made, old);
  folder.file("tree/untracked", "");
  fs::last_write_time(tree / "a.h", old);
  CHECK(version_of(tree, made) == version);
  CHECK(fs::last_write_time(made) == old);

  folder.file("tree/a.h", "2");
  CHECK(version_of(tree, made) == version.substr(0, version.size() - 1) + "+)");
  CHECK(fs::last_write_time(made) != old);
  CHECK(version_of(tree / "copy", made) == "1.2.3 (unknown)");
  REQUIRE(git("commit -a -m 2"));
  CHECK(version_of(tree, made) != version);
}

}  // namespace
}  // namespace rtusim
