#include "modules/config/files.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "modules/config/error.h"

namespace fs = std::filesystem;
using rtusim::input_error;
using rtusim::config::output_file;
using rtusim::config::read_file;

namespace {

/// An empty folder, removed at the end.
class folder {
 public:
  folder() : path_(fs::temp_directory_path() / fmt::format("rtusim_files_test-{}", ::getpid())) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~folder() { fs::remove_all(path_); }
  folder(const folder&) = delete;
  folder& operator=(const folder&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& item : fs::directory_iterator(path_)) all.push_back(item.path().filename().string());
    return all;
  }

 private:
  fs::path path_;
};

fs::path put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

std::string gzip(const std::string& bytes) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string zipped(deflateBound(&stream, bytes.size()) + 64, '\0');
  std::string input = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(zipped.data());
  stream.avail_out = static_cast<uInt>(zipped.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  zipped.resize(stream.total_out);
  deflateEnd(&stream);
  return zipped;
}

template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const input_error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("read_file returns the bytes, unzipped by their magic number and not their name") {
  const folder in;
  std::string bytes(600'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 7);
  CHECK(read_file(put(in / "plain.gz", bytes)) == bytes);
  CHECK(read_file(put(in / "empty", "")).empty());
  CHECK(read_file(put(in / "one_byte", "\x1f")) == "\x1f");
  CHECK(read_file(put(in / "zipped", gzip(bytes))) == bytes);
  CHECK(read_file(put(in / "zipped_empty", gzip(""))).empty());
  CHECK(read_file(put(in / "members", gzip(bytes) + gzip("") + gzip("tail"))) == bytes + "tail");
  CHECK(read_file(put(in / "padded", gzip("a") + std::string(512, '\0'))) == "a");
  CHECK(read_file(in / "plain.gz", bytes.size()) == bytes);
  CHECK(read_file(in / "zipped", bytes.size()) == bytes);
  CHECK(read_file("/dev/null").empty());
}

TEST_CASE("read_file refuses what it can't read whole") {
  const folder in;
  const std::string zipped = gzip(std::string(100'000, 'x') + "tail");
  std::string damaged = zipped;
  damaged[damaged.size() - 8] = static_cast<char>(damaged[damaged.size() - 8] ^ 1);
  const std::string bomb = gzip(std::string(5'000'000, '\0'));
  REQUIRE(bomb.size() < 10'000);

  const struct { fs::path file; std::string message; } table[] = {
      {in / "none", "no such file; expected a file that can be read"},
      {in / "none/below", "no such file; expected a file that can be read"},
      {put(in / "file", "") / "below", "Not a directory; expected a file that can be read"},
      {in / "", "a folder; expected a file"},
      {put(in / "large", std::string(10'001, 'x')), "more than 10000 bytes; expected a smaller file"},
      {put(in / "bomb", bomb), "more than 10000 bytes; expected a smaller file"},
      {put(in / "two_bombs", gzip("a") + bomb), "more than 10000 bytes; expected a smaller file"},
      {"/dev/zero", "more than 10000 bytes; expected a smaller file"},
  };
  for (const auto& row : table) CHECK(error_of([&] { read_file(row.file, 10'000); }) == row.file.string() + ": " + row.message);

  const auto broken = [](const fs::path& file, const std::string& how) {
    CHECK(error_of([&] { read_file(file); }) == fmt::format("{}: broken gzip data ({}); expected a whole gzip file", file.string(), how));
  };
  broken(put(in / "damaged", damaged), "incorrect data check");
  broken(put(in / "tail", zipped + "tail"), "no gzip member after the first");
  broken(put(in / "second_cut", zipped + zipped.substr(0, 20)), "it is cut short");
  for (std::size_t n = 3; n < zipped.size(); ++n) broken(put(in / "cut", zipped.substr(0, n)), "it is cut short");

  if (::geteuid() != 0) {
    const auto secret = put(in / "secret", "x");
    ::chmod(secret.c_str(), 0);
    CHECK(error_of([&] { read_file(secret); }) == secret.string() + ": Permission denied; expected a file that can be read");
  }
}

TEST_CASE("output_file puts the whole file in its place, or nothing") {
  const folder in;
  const auto file = in / "out.csv.png";
  put(file, "old");
  {
    output_file out(file);
    CHECK(out.temporary().extension() == ".png");
    CHECK(out.temporary().parent_path() == file.parent_path());
    out.write("new ");
    CHECK(read_file(file) == "old");
    out.write(std::string(3'000'000, 'x'));
    out.write({});
    out.commit();
  }
  CHECK(read_file(file) == "new " + std::string(3'000'000, 'x'));
  CHECK(in.names() == std::vector<std::string>{"out.csv.png"});
  {
    output_file out(file);
    out.write("lost");
  }
  CHECK(read_file(file).size() == 3'000'004);
  CHECK(in.names() == std::vector<std::string>{"out.csv.png"});
}

TEST_CASE("output_file lends its temporary path to a library") {
  const folder in;
  const auto file = in / "picture.exr";
  {
    output_file out(file);
    out.release();
    put(out.temporary(), "by a library");
    out.commit();
  }
  CHECK(read_file(file) == "by a library");
  {
    output_file out(in / "other.exr");
    out.release();
  }
  CHECK(in.names() == std::vector<std::string>{"picture.exr"});
}

TEST_CASE("Two output files of one name do not write into each other") {
  const folder in;
  output_file first(in / "out"), second(in / "out");
  CHECK(first.temporary() != second.temporary());
  first.write("first");
  second.write("second");
  first.commit();
  CHECK(read_file(in / "out") == "first");
  second.commit();
  CHECK(read_file(in / "out") == "second");
  CHECK(in.names().size() == 1);
}

TEST_CASE("output_file follows a link and writes devices directly") {
  const folder in;
  put(in / "target", "old");
  fs::create_symlink("target", in / "link");
  {
    output_file out(in / "link");
    out.write("new");
    out.commit();
  }
  CHECK(fs::is_symlink(in / "link"));
  CHECK(read_file(in / "target") == "new");
  {
    output_file out("/dev/null");
    CHECK(out.temporary() == "/dev/null");
    out.write("gone");
    out.commit();
  }
  CHECK(fs::is_character_file("/dev/null"));
  { const output_file uncommitted("/dev/null"); }
  CHECK(fs::is_character_file("/dev/null"));
  fs::create_symlink("loop", in / "loop");
  CHECK(error_of([&] { output_file out(in / "loop"); }) ==
        (in / "loop").string() + ": Too many levels of symbolic links; expected to write it");
}

TEST_CASE("output_file says why it can't write") {
  const folder in;
  put(in / "file", "");
  const struct { fs::path file; std::string found; } table[] = {
      {in / "none/out.json", "its folder does not exist"},
      {in / "none/", "a folder"},
      {in / "", "a folder"},
      {"", "a folder"},
      {in / "file/out.json", "Not a directory"},
      {in / std::string(300, 'x'), "File name too long"},
  };
  for (const auto& row : table)
    CHECK(error_of([&] { output_file out(row.file); }) == fmt::format("{}: {}; expected to write it", row.file.string(), row.found));

  const std::string full = "/dev/full: No space left on device; expected to write it";
  CHECK(error_of([] { output_file out("/dev/full"); out.write("x"); out.commit(); }) == full);
  CHECK(error_of([] { output_file out("/dev/full"); out.write("x"); out.release(); }) == full);
  CHECK(error_of([] { output_file out("/dev/full"); out.write(std::string(3'000'000, 'x')); }) == full);
  CHECK(in.names() == std::vector<std::string>{"file"});
}
