#include "modules/config/files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fcntl.h>
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
    std::sort(all.begin(), all.end());
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

  const struct {
    fs::path file;
    std::string message;
  } table[] = {
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
    out.write("new ");
    CHECK(read_file(file) == "old");
    REQUIRE(in.names().size() == 2);
    CHECK(in.names().front() == fmt::format(".out.csv.part-{}-0.png", rtusim::config::process_mark()));
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
  const auto long_name = in / (std::string(251, 'x') + ".csv");
  output_file out(long_name);
  out.commit();
  CHECK(read_file(long_name).empty());
}

TEST_CASE("output_file lends its open file to a library") {
  const folder in;
  const auto file = in / "picture.exr";
  output_file out(file);
  out.write("before, ");
  REQUIRE(::write(out.descriptor(), "by a library", 12) == 12);
  out.write(", behind");
  out.commit();
  CHECK(read_file(file) == "before, by a library, behind");
}

TEST_CASE("Two output files of one name do not write into each other") {
  const folder in;
  output_file first(in / "out"), second(in / "out");
  first.write("first");
  second.write("second");
  first.commit();
  CHECK(read_file(in / "out") == "first");
  second.commit();
  CHECK(read_file(in / "out") == "second");
  CHECK(in.names().size() == 1);
}

void write_whole(const fs::path& file, const std::string& bytes) {
  output_file out(file);
  out.write(bytes);
  out.commit();
}

TEST_CASE("output_file follows links and writes devices directly") {
  const folder in;
  put(in / "target", "old");
  fs::create_symlink("target", in / "link");
  fs::create_directory(in / "below");
  fs::create_symlink("../link", in / "below/far");
  fs::create_symlink("made", in / "dangling");
  write_whole(in / "below/far", "new");
  CHECK(read_file(in / "target") == "new");
  write_whole(in / "dangling", "made");
  CHECK(read_file(in / "made") == "made");
  for (const char* name : {"link", "below/far", "dangling"}) CHECK(fs::is_symlink(in / name));

  write_whole("/dev/null", "gone");
  { const output_file uncommitted("/dev/null"); }
  CHECK(fs::is_character_file("/dev/null"));
  fs::create_symlink("loop", in / "loop");
  CHECK(error_of([&] { output_file out(in / "loop"); }) ==
        (in / "loop").string() + ": Too many levels of symbolic links; expected to write it");
}

TEST_CASE("output_file keeps the mode of a file that was there") {
  const folder in;
  for (const mode_t mode : {0600, 0640, 0755, 0666}) {
    const auto file = put(in / "out", "old");
    REQUIRE(::chmod(file.c_str(), mode) == 0);
    {
      output_file out(file);
      struct stat part {};
      REQUIRE(::stat((in / in.names().front()).c_str(), &part) == 0);
      CHECK((part.st_mode & 0777) == mode);
    }
    write_whole(file, "new");
    struct stat found {};
    REQUIRE(::stat(file.c_str(), &found) == 0);
    CHECK((found.st_mode & 0777) == mode);
    CHECK(read_file(file) == "new");
  }
}

TEST_CASE("An output by the name of an open file goes on where that stands") {
  const folder in;
  const auto file = put(in / "all.csv", "before\n");
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND);
  REQUIRE(descriptor >= 0);
  fs::create_symlink(fmt::format("/dev/fd/{}", descriptor), in / "link.csv");
  for (const auto& name : {fs::path(fmt::format("/dev/fd/{}", descriptor)), fs::path(fmt::format("/proc/self/fd/{}", descriptor)),
                           fs::path(fmt::format("/proc/{}/fd/{}", ::getpid(), descriptor)), in / "link.csv"}) {
    CAPTURE(name);
    CHECK(rtusim::config::descriptor_named(name) == descriptor);
    rtusim::config::check_writable(name);
    write_whole(name, "more\n");
  }
  ::close(descriptor);
  CHECK(read_file(file) == "before\nmore\nmore\nmore\nmore\n");
  CHECK(in.names().size() == 2);
  CHECK(rtusim::config::descriptor_named("-") == STDOUT_FILENO);
  CHECK(rtusim::config::descriptor_named("/dev/stdout") == STDOUT_FILENO);
  for (const auto& name : {in / "all.csv", in / "none", fs::path("/dev/null"), fs::path("1"), in / "link.csv/1", fs::path()})
    CHECK(!rtusim::config::descriptor_named(name));
  CHECK(error_of([] { output_file out("/dev/fd/987"); }) == "/dev/fd/987: Bad file descriptor; expected to write it");
}

TEST_CASE("No output is the file of an input or of another output") {
  const folder in;
  const auto model = put(in / "model.svo", "x"), other = put(in / "other.csv", "x");
  fs::create_symlink("model.svo", in / "link");
  fs::create_hard_link(model, in / "twin");
  fs::create_symlink("new.csv", in / "dangling");
  fs::create_directory(in / "below");
  using list = std::vector<fs::path>;
  const struct {
    list outputs, inputs;
    fs::path place;
    std::string found;
  } refused[] = {
      {{model}, {model}, model, "the file of the input " + model.string()},
      {{in / "link"}, {model}, in / "link", "the file of the input " + model.string()},
      {{in / "twin"}, {"", model}, in / "twin", "the file of the input " + model.string()},
      {{other, in / "below/../model.svo"}, {in / "link"}, in / "below/../model.svo", "the file of the input " + (in / "link").string()},
      {{other, "", in / "./other.csv"}, {}, in / "./other.csv", "the file of the output " + other.string() + ", too"},
      {{in / "new.csv", in / "dangling"}, {}, in / "dangling", "the file of the output " + (in / "new.csv").string() + ", too"},
      {{"-", "/dev/stdout"}, {}, "/dev/stdout", "the file of the output -, too"},
  };
  for (const auto& r : refused) {
    const std::string expected = r.place == "/dev/stdout" ? "at most one output there" : "a file of its own";
    CHECK(error_of([&] { rtusim::config::check_writable_apart(r.outputs, r.inputs); }) ==
          fmt::format("{}: {}; expected {}", r.place.string(), r.found, expected));
  }
  rtusim::config::check_writable_apart({other, in / "new.csv", "-", "/dev/null", "/dev/null"}, {model, "", in / "missing", "/dev/null"});
  CHECK(read_file(model) == "x");
  CHECK(!fs::exists(in / "new.csv"));
  using rtusim::config::stream_beside;
  CHECK(stream_beside({other, ""}) == stdout);
  CHECK(stream_beside({other, "-"}) == stderr);
  CHECK(stream_beside({"/proc/self/fd/1"}) == stderr);
}

TEST_CASE("output_file says why it can't write") {
  const folder in;
  put(in / "file", "");
  const struct {
    fs::path file;
    std::string found;
  } table[] = {
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
  CHECK(error_of([] {
          output_file out("/dev/full");
          out.write("x");
          out.commit();
        }) == full);
  CHECK(error_of([] {
          output_file out("/dev/full");
          out.write("x");
          out.descriptor();
        }) == full);
  CHECK(error_of([] {
          output_file out("/dev/full");
          out.write(std::string(3'000'000, 'x'));
        }) == full);
  CHECK(in.names() == std::vector<std::string>{"file"});
}
