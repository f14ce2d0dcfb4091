#include "testbench/run/job_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <unistd.h>

#include "modules/config/error.h"
#include "modules/config/files.h"

using namespace rtusim;
namespace fs = std::filesystem;

namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/sys/";

/// A folder of this process' own, gone at the end.
struct scratch {
  fs::path folder = fs::temp_directory_path() / ("rtusim_job_file_test_" + std::to_string(getpid()));
  scratch() { fs::create_directories(folder); }
  ~scratch() { fs::remove_all(folder); }
  fs::path file(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("job_file: a golden file is read, and written again byte for byte") {
  const scratch tmp;
  const auto jobs = read_jobs(golden + "jobs_64x36_literal.bin.gz");
  REQUIRE(jobs.size() == 64 * 36);
  for (std::size_t i = 0; i < jobs.size(); ++i) REQUIRE(jobs[i].pixel() == i);

  write_jobs(tmp.folder / "jobs.bin", jobs);
  CHECK(bytes_of(tmp.folder / "jobs.bin") == config::read_file(golden + "jobs_64x36_literal.bin.gz"));
}

TEST_CASE("job_file: more jobs than one write takes") {
  const scratch tmp;
  std::vector<job_packet> jobs(3 * 4096 + 1);
  for (std::uint32_t i = 0; i < jobs.size(); ++i) jobs[i] = {i, {i + 1, i + 2, i + 3}, {i + 4, i + 5, i + 6}, i + 7};
  write_jobs(tmp.folder / "jobs.bin", jobs);
  const auto again = read_jobs(tmp.folder / "jobs.bin");
  REQUIRE(again.size() == jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    REQUIRE(again[i].job_word == jobs[i].job_word);
    REQUIRE(again[i].t0 == jobs[i].t0);
    REQUIRE(again[i].t1 == jobs[i].t1);
    REQUIRE(again[i].address == jobs[i].address);
  }
}

TEST_CASE("job_file: words are little-endian, in the packet's order, and none is refused") {
  const scratch tmp;
  const std::string bytes(
      "\x01\x02\x03\xf4"
      "\x00\x00\xc0\x7f"
      "\x00\x00\x80\xff"
      "\xff\xff\xff\xff"
      "\x10\x00\x00\x00"
      "\x20\x00\x00\x00"
      "\x30\x00\x00\x00"
      "\x0d\x0c\x0b\x0a",
      32);
  const auto jobs = read_jobs(tmp.file("raw.bin", bytes));
  REQUIRE(jobs.size() == 1);
  CHECK(jobs[0].job_word == 0xf4030201);
  CHECK(jobs[0].t0 == per_axis<std::uint32_t>{0x7fc00000, 0xff800000, 0xffffffff});
  CHECK(jobs[0].t1 == per_axis<std::uint32_t>{0x10, 0x20, 0x30});
  CHECK(jobs[0].address == 0x0a0b0c0d);
}

TEST_CASE("job_file: what is no job file is refused by name") {
  const scratch tmp;
  CHECK_THROWS_WITH(read_jobs(tmp.file("empty.bin", "")), Catch::Contains("empty.bin") && Catch::Contains("no jobs"));
  CHECK_THROWS_WITH(read_jobs(tmp.file("cut.bin", std::string(33, 'x'))), Catch::Contains("cut.bin") && Catch::Contains("33 bytes"));
  CHECK_THROWS_AS(read_jobs(tmp.folder / "missing.bin"), input_error);
  CHECK_THROWS_AS(read_jobs(tmp.folder), input_error);
  CHECK_THROWS_AS(write_jobs(tmp.folder / "missing" / "jobs.bin", {job_packet{}}), input_error);
}
