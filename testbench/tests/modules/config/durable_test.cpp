#include "modules/config/durable.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <string>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "testbench/tests/scratch.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;
using test::scratch_folder;

TEST_CASE("A new file is written once, and never through a link") {
  const scratch_folder folder;
  write_new_file(folder / "new", "text");
  CHECK(read_file(folder / "new") == "text");
  CHECK_THROWS_AS(write_new_file(folder / "new", "other"), input_error);
  CHECK(read_file(folder / "new") == "text");
  fs::create_symlink("target", folder / "link");
  CHECK_THROWS_AS(write_new_file(folder / "link", "text"), input_error);
  CHECK_FALSE(fs::exists(folder / "target"));
  CHECK_THROWS_AS(write_new_file(folder / "none/new", "text"), input_error);
  CHECK_THROWS_AS(write_new_file("/dev/full", "text"), input_error);
}

TEST_CASE("What is synced must be there") {
  const scratch_folder folder;
  const fs::path file = folder.file("file", "text");
  sync_folder(folder);
  sync_file_system(folder);
  CHECK_THROWS_WITH(sync_folder(folder / "none"),
                    (folder / "none").string() + ": No such file or directory; expected to write it to the disk");
  CHECK_THROWS_AS(sync_folder(file), input_error);
  CHECK_THROWS_AS(sync_file_system(folder / "none"), input_error);
}

}  // namespace
}  // namespace rtusim::config
