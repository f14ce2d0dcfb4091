#include "modules/config/input_ledger.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include <zlib.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "testbench/tests/scratch.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;
using test::scratch_folder;

TEST_CASE("SHA-256 as FIPS 180-4 has it") {
  CHECK(sha256_of("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_of("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_of(std::string(1'000'000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("A ledger notes what is read while it lives, with its true place and the checksum of what was loaded") {
  const scratch_folder folder;
  folder.file("before", "0");
  const fs::path a = folder.file("a", "one");
  fs::create_symlink("a", folder / "link");
  CHECK(read_file(folder / "before") == "0");
  const input_ledger outer;
  {
    const input_ledger inner;
    CHECK(read_file(folder / "link") == "one");
    std::thread([&] { read_file(a); }).join();
    CHECK_THROWS_AS(read_file(folder / "none"), input_error);
    CHECK(read_file(a) == "one");
    const auto files = inner.files();
    REQUIRE(files.size() == 2);
    CHECK(files[0].file == folder / "link");
    CHECK(files[0].canonical == fs::canonical(a));
    CHECK(files[0].bytes == 3);
    CHECK(files[0].sha256 == sha256_of("one"));
    CHECK(files[1].file == a);
  }
  folder.file("a", "other");
  CHECK(read_file(a) == "other");
  CHECK(read_file("/dev/null").empty());
  const auto files = outer.files();
  REQUIRE(files.size() == 4);
  CHECK(files[2].file == a);
  CHECK(files[2].sha256 == sha256_of("other"));
  CHECK(files[3].canonical == "/dev/null");
  CHECK(files[3].bytes == 0);
}

TEST_CASE("A zipped file is noted as it lies there") {
  const scratch_folder folder;
  const fs::path file = folder / "zipped.gz";
  gzFile zipped = gzopen(file.c_str(), "wb");
  REQUIRE(gzwrite(zipped, "text", 4) == 4);
  REQUIRE(gzclose(zipped) == Z_OK);
  const input_ledger ledger;
  CHECK(read_file(file) == "text");
  CHECK(ledger.files().at(0).bytes == fs::file_size(file));
}

TEST_CASE("A ledger keeps no more bytes than it may, and notes the rest") {
  const scratch_folder folder;
  const fs::path large = folder.file("large", "123456"), small = folder.file("small", "1234"), last = folder.file("last", "12");
  const input_ledger keeper(input_ledger::keeping::bytes, 5);
  for (const fs::path& file : {large, small, last}) read_file(file);
  for (const char* name : {"large", "small", "last"}) folder.file(name, "new");
  CHECK(read_file(large) == "new");
  CHECK(read_file(small) == "1234");
  CHECK(read_file(last) == "new");
  CHECK(keeper.files().size() == 5);  // two of them twice
}

TEST_CASE("A ledger that keeps bytes gives the same file again, whatever became of it") {
  const scratch_folder folder;
  const fs::path replaced = folder.file("replaced", "one"), removed = folder.file("removed", "two");
  std::optional<input_ledger> keeper(input_ledger::keeping::bytes);
  CHECK(read_file(replaced) == "one");
  CHECK(read_file(removed) == "two");
  folder.file("replaced", "another");
  fs::remove(removed);
  {
    const input_ledger inner;
    CHECK(read_file(replaced) == "one");
    CHECK(read_file(removed) == "two");
    CHECK(inner.files().at(0).sha256 == sha256_of("one"));
    CHECK_THROWS_AS(read_file(replaced, 2), input_error);
  }
  CHECK(keeper->files().size() == 2);
  keeper.reset();
  CHECK(read_file(replaced) == "another");
  CHECK_THROWS_AS(read_file(removed), input_error);
}

}  // namespace
}  // namespace rtusim::config
