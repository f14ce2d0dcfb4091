#include "testbench/pictures.h"

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <catch2/catch.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "modules/config/error.h"

using namespace rtusim;
namespace fs = std::filesystem;

namespace {

/// A folder of this process' own, gone at the end.
struct scratch {
  fs::path folder = fs::temp_directory_path() / ("rtusim_pictures_test_" + std::to_string(getpid()));
  scratch() { fs::create_directories(folder); }
  ~scratch() { fs::remove_all(folder); }
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

traversal_result hit(std::uint32_t job_word, double t, std::int8_t axis, std::int8_t sign, std::uint32_t cost, std::uint16_t core) {
  traversal_result r;
  r.job_word = job_word;
  r.cost = cost;
  r.t_hit = static_cast<std::int64_t>(t * 65536);
  r.hit = true;
  r.normal_axis = axis;
  r.normal_sign = sign;
  r.core = core;
  return r;
}

traversal_result miss(std::uint32_t job_word, std::uint32_t cost, std::uint16_t core) {
  traversal_result r = hit(job_word, 123, 1, 1, cost, core);  // as built, a miss carries the core's last hit
  r.hit = false;
  return r;
}

/// Three hits, one an axis; two misses, of cost 2 and 42; one pixel without a result.
frame small_frame() {
  frame f({3, 2}, 16);
  f.store(hit(0 | 5u << 28, 1.5, 0, -1, 20, 0), 30);
  f.store(hit(1, 2.0, 1, 1, 21, 1), 31);
  f.store(hit(2, 3.5, 2, -1, 22, 2), 32);
  f.store(miss(3, 2, 3), 5);
  f.store(miss(4, 42, 15), 45);
  return f;
}

using rgb = std::array<int, 3>;

std::vector<rgb> png_pixels(const fs::path& file) {
  auto in = OIIO::ImageInput::open(file.string());
  REQUIRE(in);
  REQUIRE(in->spec().nchannels == 3);
  REQUIRE(in->spec().format == OIIO::TypeDesc::UINT8);
  CHECK(in->spec().get_string_attribute("oiio:ColorSpace") == "sRGB");
  std::vector<std::uint8_t> bytes(in->spec().image_bytes());
  REQUIRE(in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
  std::vector<rgb> pixels;
  for (std::size_t i = 0; i < bytes.size(); i += 3) pixels.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
  return pixels;
}

std::map<std::string, std::vector<float>> exr_channels(const fs::path& file) {
  auto in = OIIO::ImageInput::open(file.string());
  REQUIRE(in);
  const auto& names = in->spec().channelnames;
  std::vector<float> values(in->spec().image_pixels() * names.size());
  REQUIRE(in->read_image(0, 0, 0, static_cast<int>(names.size()), OIIO::TypeDesc::FLOAT, values.data()));
  std::map<std::string, std::vector<float>> channels;
  for (std::size_t i = 0; i < values.size(); ++i) channels[names[i % names.size()]].push_back(values[i]);
  return channels;
}

}  // namespace

TEST_CASE("frame: results find their pixels by the low 28 bits of the job word") {
  frame f = small_frame();
  CHECK(f.arrived() == 5);
  CHECK(f.at(0, 0).t_hit == 1.5);
  CHECK(f.at(0, 0).normal_axis == 0);
  CHECK(f.at(0, 0).normal_sign == -1);
  CHECK(f.at(0, 0).latency_cycles == 30);
  CHECK(f.at(1, 1).cost == 42);
  CHECK(f.at(1, 1).core == 15);
  CHECK(f.at(1, 1).t_hit == 0);
  CHECK(f.at(1, 1).normal_axis == no_axis);
  CHECK(f.at(1, 1).arrived);
  CHECK_FALSE(f.at(2, 1).arrived);

  CHECK_FALSE(f.store(miss(6, 2, 0), 1));
  CHECK_FALSE(f.store(miss(0xffffffffu, 2, 0), 1));
  CHECK(f.strays() == 2);
  CHECK(f.store(miss(0, 7, 0), 1));
  CHECK(f.arrived() == 5);
  CHECK(f.at(0, 0).cost == 7);
  CHECK_FALSE(f.at(0, 0).hit);
}

TEST_CASE("frame: t_hit in world units at other precisions") {
  traversal_result r = hit(0, 0, 0, 1, 2, 0);
  r.t_hit = -3;
  for (const unsigned fraction_bits : {0u, 1u, 8u, 24u, 40u}) {
    frame f({1, 1}, fraction_bits);
    f.store(r, 0);
    CHECK(f.at(0, 0).t_hit == -3.0 / static_cast<double>(std::uint64_t{1} << fraction_bits));
  }
}

TEST_CASE("pictures: the kind by the file's name") {
  const std::vector<std::pair<const char*, picture_kind>> known{
      {"x.png", picture_kind::shaded},        {"a/b.c/x.png", picture_kind::shaded}, {"x.PNG", picture_kind::shaded},
      {"x.cost.png", picture_kind::cost},     {"a.b.cost.png", picture_kind::cost},  {"x.depth.png", picture_kind::depth},
      {"x.exr", picture_kind::layers},        {"x.v2.exr", picture_kind::layers},
  };
  for (const auto& [name, kind] : known) CHECK(kind_of(name) == kind);
  for (const char* name : {"x.jpg", "x", "", ".png", "x.png.gz", "x.dept.png", "x.cost.b.png", "png", "x.exr/"})
    CHECK_THROWS_WITH(kind_of(name), Catch::Contains("NAME.cost.png") && Catch::Contains("NAME.exr"));
}

TEST_CASE("pictures: shaded by the normal's axis, misses white, nothing black") {
  const scratch tmp;
  write_picture(tmp.folder / "x.png", small_frame(), picture_kind::shaded);
  const std::vector<rgb> expected{{178, 178, 178}, {229, 229, 229}, {127, 127, 127}, {255, 255, 255}, {255, 255, 255}, {0, 0, 0}};
  CHECK(png_pixels(tmp.folder / "x.png") == expected);
}

TEST_CASE("pictures: misses by their cost") {
  const scratch tmp;
  write_picture(tmp.folder / "x.cost.png", small_frame(), picture_kind::cost);
  // 0.95^20 * 255 = 91.4
  const std::vector<rgb> expected{{178, 178, 178}, {229, 229, 229}, {127, 127, 127}, {255, 255, 255}, {255, 91, 91}, {0, 0, 0}};
  CHECK(png_pixels(tmp.folder / "x.cost.png") == expected);
}

TEST_CASE("pictures: depth from light to dark") {
  const scratch tmp;
  write_picture(tmp.folder / "x.depth.png", small_frame(), picture_kind::depth);
  const auto pixels = png_pixels(tmp.folder / "x.depth.png");
  CHECK(pixels[0] == rgb{242, 242, 242});  // 0.95
  CHECK(pixels[1] == rgb{191, 191, 191});  // a quarter of the way to
  CHECK(pixels[2] == rgb{38, 38, 38});     // 0.15
  CHECK(pixels[3] == pixels[4]);
  CHECK(pixels[3][2] > pixels[3][0]);
  CHECK(pixels[5] == rgb{0, 0, 0});
}

TEST_CASE("pictures: depth of frames without a span") {
  const scratch tmp;
  frame f({2, 1}, 16);
  write_picture(tmp.folder / "none.depth.png", f, picture_kind::depth);
  CHECK(png_pixels(tmp.folder / "none.depth.png")[0] == rgb{0, 0, 0});
  f.store(hit(1, 2, 0, 1, 9, 0), 9);
  write_picture(tmp.folder / "one.depth.png", f, picture_kind::depth);
  CHECK(png_pixels(tmp.folder / "one.depth.png")[1] == rgb{242, 242, 242});
}

TEST_CASE("pictures: every layer in one EXR") {
  const scratch tmp;
  write_picture(tmp.folder / "x.exr", small_frame(), picture_kind::layers);
  auto channels = exr_channels(tmp.folder / "x.exr");
  using values = std::vector<float>;
  CHECK(channels.size() == 11);
  CHECK(channels["hit"] == values{1, 1, 1, 0, 0, 0});
  CHECK(channels["depth"] == values{1.5, 2, 3.5, 0, 0, 0});
  CHECK(channels["normal.x"] == values{-1, 0, 0, 0, 0, 0});
  CHECK(channels["normal.y"] == values{0, 1, 0, 0, 0, 0});
  CHECK(channels["normal.z"] == values{0, 0, -1, 0, 0, 0});
  CHECK(channels["cost"] == values{20, 21, 22, 2, 42, 0});
  CHECK(channels["core"] == values{0, 1, 2, 3, 15, -1});
  CHECK(channels["latency"] == values{30, 31, 32, 5, 45, 0});
  CHECK(channels["R"] == channels["B"]);
  CHECK(channels["G"][0] == Approx(0.4479884));  // 0.7 in linear light
  CHECK(channels["G"][3] == 1);
  CHECK(channels["G"][5] == 0);
}

TEST_CASE("pictures: the same frame gives the same bytes, without a date") {
  const scratch tmp;
  frame f({70, 150}, 16);  // more rows than a band
  for (std::uint32_t i = 0; i < 70 * 150; ++i) f.store(hit(i, i / 1000.0, static_cast<std::int8_t>(i % 3), 1, i % 99, 0), i);
  for (const char* name : {"x.png", "x.depth.png", "x.cost.png", "x.exr"}) {
    INFO(name);
    write_picture(tmp.folder / name, f, kind_of(name));
    const std::string first = bytes_of(tmp.folder / name);
    write_picture(tmp.folder / name, f, kind_of(name));
    CHECK(bytes_of(tmp.folder / name) == first);
    CHECK(first.find("tIME") == std::string::npos);
    CHECK(first.find("part-") == std::string::npos);  // of the temporary name
    CHECK(OIIO::ImageInput::open((tmp.folder / name).string())->spec().get_string_attribute("DateTime").empty());
  }
  auto cost = exr_channels(tmp.folder / "x.exr")["cost"];
  for (std::uint32_t i = 0; i < cost.size(); ++i) REQUIRE(cost[i] == static_cast<float>(i % 99));
}

TEST_CASE("pictures: a place that can't be written is refused, and nothing is left there") {
  const scratch tmp;
  const frame f = small_frame();
  for (const char* name : {"x.png", "x.exr"}) {
    CHECK_THROWS_AS(write_picture(tmp.folder / "missing" / name, f, kind_of(name)), input_error);
    fs::create_directories(tmp.folder / name / "occupied");
    CHECK_THROWS_AS(write_picture(tmp.folder / name, f, kind_of(name)), input_error);
  }
  for (const auto& entry : fs::directory_iterator(tmp.folder)) CHECK(entry.is_directory());
}

TEST_CASE("pictures: a disk that fills up is refused, and nothing is left there") {
  const scratch tmp;
  frame f({64, 64}, 16);
  for (std::uint32_t i = 0; i < 64 * 64; ++i) f.store(hit(i, i / 9.0, static_cast<std::int8_t>(i * 7 % 3), 1, i % 99, 0), i);

  // A limit on the size of files stands in for the disk. Its few bytes fill up at the first write or at the last one.
  rlimit old{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &old) == 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  std::vector<std::string> survived;
  for (const char* name : {"x.png", "x.depth.png", "x.exr"})
    for (const rlim_t bytes : {0, 10, 200}) {
      const rlimit tight{bytes, old.rlim_max};
      setrlimit(RLIMIT_FSIZE, &tight);
      try {
        write_picture(tmp.folder / name, f, kind_of(name));
        survived.push_back(name + (' ' + std::to_string(bytes)));
      } catch (const input_error&) {
      }
      setrlimit(RLIMIT_FSIZE, &old);
    }
  std::signal(SIGXFSZ, old_handler);
  CHECK(survived == std::vector<std::string>{});
  CHECK(fs::is_empty(tmp.folder));
}
