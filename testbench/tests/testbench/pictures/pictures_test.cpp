#include "testbench/pictures/pictures.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
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

voxel_result hit(std::uint32_t job_word, double t, std::int8_t axis, std::int8_t sign, std::uint32_t cost, std::uint16_t core) {
  voxel_result r;
  r.job_word = job_word;
  r.cost = cost;
  r.t_hit = static_cast<std::int64_t>(t * 65536);
  r.hit = true;
  r.normal_axis = axis;
  r.normal_sign = sign;
  r.core = core;
  return r;
}

voxel_result miss(std::uint32_t job_word, std::uint32_t cost, std::uint16_t core) {
  voxel_result r = hit(job_word, 123, 1, 1, cost, core);  // as built, a miss carries the core's last hit
  r.hit = false;
  return r;
}

/// Three hits, one an axis; two misses, of cost 2 and 42; one pixel without a result. Rays that never wait take their cost and 2 cycles.
frame small_frame() {
  frame f({3, 2}, 16);
  f.set_way(2);
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

/// What misses look like, and pixels to which no ray was sent, where they have no colour by a number.
constexpr rgb background{236, 237, 240};

bool near(const rgb& a, const rgb& b) { return std::abs(a[0] - b[0]) <= 1 && std::abs(a[1] - b[1]) <= 1 && std::abs(a[2] - b[2]) <= 1; }

std::string description(const fs::path& file) {
  return std::string(OIIO::ImageInput::open(file.string())->spec().get_string_attribute("ImageDescription"));
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
  CHECK(f.arrived() == 5);
}

TEST_CASE("frame: of several results for a pixel it keeps the nearest hit, of equals that of the earlier job") {
  frame f({3, 2}, 16);
  const auto result = [](bool is_hit, double t, std::uint32_t sequence) {
    voxel_result r = is_hit ? hit(0, t, 0, 1, 10 + sequence, 0) : miss(0, 10 + sequence, 0);
    r.sequence = sequence;
    return r;
  };
  const auto kept = [&] { return f.at(0, 0).sequence; };
  CHECK(f.store(result(false, 0, 4), 30));
  CHECK(f.store(result(false, 0, 3), 30));
  CHECK_FALSE(f.store(result(false, 0, 5), 30));
  CHECK(kept() == 3);
  CHECK(f.store(result(true, 2.5, 6), 30));
  CHECK_FALSE(f.store(result(false, 0, 0), 30));
  CHECK_FALSE(f.store(result(true, 2.75, 1), 30));
  CHECK_FALSE(f.store(result(true, 2.5, 7), 30));
  CHECK(kept() == 6);
  CHECK(f.store(result(true, 2.5, 2), 30));
  CHECK(f.store(result(true, 1.5, 9), 31));
  CHECK(kept() == 9);
  CHECK(f.at(0, 0).cost == 19);
  CHECK(f.at(0, 0).t_hit == 1.5);
  CHECK(f.at(0, 0).latency_cycles == 31);
  CHECK(f.arrived() == 1);
}

TEST_CASE("frame: t_hit in world units at other precisions") {
  voxel_result r = hit(0, 0, 0, 1, 2, 0);
  r.t_hit = -3;
  for (const unsigned fraction_bits : {0u, 1u, 8u, 24u, 40u}) {
    frame f({1, 1}, fraction_bits);
    f.store(r, 0);
    CHECK(f.at(0, 0).t_hit == -3.0 / static_cast<double>(std::uint64_t{1} << fraction_bits));
  }
}

TEST_CASE("pictures: the kind by the file's name") {
  const std::vector<std::pair<const char*, picture_kind>> known{
      {"x.png", picture_kind::shaded},        {"a/b.c/x.png", picture_kind::shaded},  {"x.PNG", picture_kind::shaded},
      {"x.cost.png", picture_kind::cost},     {"a.b.cost.png", picture_kind::cost},   {"x.depth.png", picture_kind::depth},
      {"x.exr", picture_kind::layers},        {"x.v2.exr", picture_kind::layers},     {"x.lit.png", picture_kind::lit},
      {"x.normal.png", picture_kind::normal}, {"x.heat.png", picture_kind::heat},     {"x.latency.png", picture_kind::latency},
      {"x.wait.png", picture_kind::wait},     {"x.core.png", picture_kind::core},     {"x.model.png", picture_kind::model},
      {"x.sheet.png", picture_kind::sheet},   {"X.DEPTH.PNG", picture_kind::depth},   {"my.render.png", picture_kind::shaded},
      {"x.0001.png", picture_kind::shaded},   {"x.cost.b.png", picture_kind::shaded}, {"x..png", picture_kind::shaded},
  };
  for (const auto& [name, kind] : known) CHECK(kind_of(name) == kind);
  for (const char* name : {"x.jpg", "x", "", ".png", "x.png.gz", "png", "x.exr/"})
    CHECK_THROWS_WITH(kind_of(name), Catch::Contains("NAME.cost.png") && Catch::Contains("NAME.exr"));
  const std::pair<const char*, const char*> nearly[] = {
      {"x.dept.png", "NAME.depth.png"}, {"x.Cots.png", "NAME.cost.png"}, {"x.sheets.png", "NAME.sheet.png"}, {"x.lti.png", "NAME.lit.png"}};
  for (const auto& [name, meant] : nearly)
    CHECK_THROWS_WITH(kind_of(name),
                      Catch::Contains("unknown kind of picture") && Catch::EndsWith(std::string(meant) + ", or another name"));
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
  CHECK(channels.size() == 23);
  CHECK(channels["hit"] == values{1, 1, 1, 0, 0, 0});
  CHECK(channels["depth"] == values{1.5, 2, 3.5, 0, 0, 0});
  CHECK(channels["normal.x"] == values{-1, 0, 0, 0, 0, 0});
  CHECK(channels["normal.y"] == values{0, 1, 0, 0, 0, 0});
  CHECK(channels["normal.z"] == values{0, 0, -1, 0, 0, 0});
  CHECK(channels["cost"] == values{20, 21, 22, 2, 42, 0});
  CHECK(channels["core"] == values{0, 1, 2, 3, 15, -1});
  CHECK(channels["latency"] == values{30, 31, 32, 5, 45, 0});
  CHECK(channels["wait"] == values{8, 8, 8, 1, 1, 0});
  CHECK(channels["model"] == values{0, 0, 0, -1, -1, -1});
  CHECK(channels["ambient"] == values{1, 1, 1, 1, 1, 1});
  for (const char* name : {"position.x", "position.y", "position.z"}) CHECK(channels[name] == values(6, 0));
  for (const char* name : {"voxel.x", "voxel.y", "voxel.z"}) CHECK(channels[name] == values(6, -1));
  for (const char* name : {"lit.R", "lit.G", "lit.B"}) {
    CHECK(channels[name][1] > channels[name][0]);
    CHECK(channels[name][5] == 0);
  }
  CHECK(channels["R"] == channels["B"]);
  CHECK(channels["G"][0] == Approx(0.4479884));  // 0.7 in linear light
  CHECK(channels["G"][3] == 1);
  CHECK(channels["G"][5] == 0);
}

TEST_CASE("pictures: an EXR's table leads to its chunks, not a reader's search for them") {
  const scratch tmp;
  write_picture(tmp.folder / "x.exr", frame({40, 30}, 16), picture_kind::layers);
  const std::string bytes = bytes_of(tmp.folder / "x.exr");
  const auto number = [&](std::size_t at, unsigned size) {
    std::uint64_t n = 0;
    REQUIRE(at + size <= bytes.size());
    for (unsigned i = 0; i < size; ++i) n |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return static_cast<std::size_t>(n);
  };
  // Magic number and version; attributes of name, type, size and data, the last of an empty name.
  std::size_t at = 8;
  while (bytes[at] != '\0') {
    const std::size_t type = bytes.find('\0', at) + 1, size = bytes.find('\0', type) + 1;
    at = size + 4 + number(size, 4);
  }
  const std::size_t table = at + 1, chunks = (number(table, 8) - table) / 8;
  REQUIRE(chunks >= 1);
  REQUIRE(chunks <= 30);
  // Each chunk is the first row's number, a size and so many bytes; they follow one another to the end.
  std::size_t next = table + 8 * chunks;
  for (std::size_t i = 0; i < chunks; ++i) {
    CHECK(number(table + 8 * i, 8) == next);
    next += 8 + number(next + 4, 4);
  }
  CHECK(next == bytes.size());
}

TEST_CASE("pictures: normals as colours") {
  const scratch tmp;
  write_picture(tmp.folder / "x.normal.png", small_frame(), picture_kind::normal);
  const std::vector<rgb> expected{{0, 127, 127}, {127, 255, 127}, {127, 127, 0}, background, background, {0, 0, 0}};
  CHECK(png_pixels(tmp.folder / "x.normal.png") == expected);
}

TEST_CASE("pictures: cost, latency and wait on scales from the least to the greatest") {
  const scratch tmp;
  // The scales' ends and middles as Matplotlib publishes them, of which OpenImageIO has its table.
  constexpr rgb inferno_low{0, 0, 3}, inferno_high{252, 254, 164}, viridis_low{68, 1, 84}, viridis_high{253, 231, 36};
  frame f = small_frame();
  write_picture(tmp.folder / "x.heat.png", f, picture_kind::heat);
  const auto heat = png_pixels(tmp.folder / "x.heat.png");
  CHECK(near(heat[3], inferno_low));
  CHECK(near(heat[4], inferno_high));
  CHECK(heat[0][0] < heat[1][0]);
  CHECK(heat[1][0] < heat[2][0]);
  CHECK(heat[5] == rgb{0, 0, 0});
  CHECK(description(tmp.folder / "x.heat.png") == "Cost: colours from 2 to 42 cycles");

  write_picture(tmp.folder / "x.latency.png", f, picture_kind::latency);
  const auto latency = png_pixels(tmp.folder / "x.latency.png");
  CHECK(near(latency[3], viridis_low));
  CHECK(near(latency[4], viridis_high));
  CHECK(description(tmp.folder / "x.latency.png") == "Latency: colours from 5 to 45 cycles");

  write_picture(tmp.folder / "x.wait.png", f, picture_kind::wait);
  const auto wait = png_pixels(tmp.folder / "x.wait.png");
  CHECK(wait == std::vector<rgb>{wait[0], wait[0], wait[0], wait[3], wait[3], {0, 0, 0}});
  CHECK(near(wait[0], viridis_high));
  CHECK(near(wait[3], viridis_low));
  CHECK(description(tmp.folder / "x.wait.png") == "Wait: colours from 1 to 8 cycles");
}

TEST_CASE("pictures: a scale ends where nearly all rays do") {
  const scratch tmp;
  frame f({1000, 1}, 16);
  for (std::uint32_t i = 0; i < 1000; ++i) f.store(miss(i, i < 997 ? 10 + i % 91 : 5000, 0), 1 + i);
  write_picture(tmp.folder / "x.heat.png", f, picture_kind::heat);
  CHECK(description(tmp.folder / "x.heat.png") == "Cost: colours from 10 to 100 cycles and more");
  const auto pixels = png_pixels(tmp.folder / "x.heat.png");
  CHECK(pixels[999] == pixels[90]);
  CHECK(pixels[89] != pixels[90]);
}

TEST_CASE("pictures: rays that were not sent have a colour of their own") {
  const scratch tmp;
  frame f({2, 1}, 16);
  job_packet sent;
  sent.job_word = 1;
  f.leave_out_all_but({sent});
  f.store(miss(1, 7, 0), 12);
  for (const char* name : {"x.heat.png", "x.latency.png", "x.wait.png", "x.core.png"}) {
    write_picture(tmp.folder / name, f, kind_of(name));
    const auto pixels = png_pixels(tmp.folder / name);
    CHECK(pixels[0] == background);
    CHECK(pixels[1] != background);
  }
}

TEST_CASE("pictures: cores in the colours of Okabe and Ito, then at half their brightness, then again") {
  const scratch tmp;
  frame f({18, 1}, 16);
  for (std::uint16_t i = 0; i < 17; ++i) f.store(miss(i, 2, i), 9);
  write_picture(tmp.folder / "x.core.png", f, picture_kind::core);
  const auto pixels = png_pixels(tmp.folder / "x.core.png");
  CHECK(pixels[0] == rgb{230, 159, 0});
  CHECK(pixels[1] == rgb{86, 180, 233});
  CHECK(pixels[6] == rgb{204, 121, 167});
  CHECK(pixels[8] == rgb{115, 79, 0});
  CHECK(pixels[16] == pixels[0]);
  CHECK(pixels[17] == rgb{0, 0, 0});
}

TEST_CASE("pictures: which voxel was hit") {
  const scratch tmp;
  frame f({5, 1}, 16);
  f.store(hit(0, 1, 0, -1, 9, 0), 20);
  f.store(hit(1, 1, 0, 1, 9, 0), 20);
  f.store(hit(2, 1, 1, 1, 9, 0), 20);
  f.store(hit(3, 1, 1, 1, 9, 0), 20);  // of the same voxel
  f.store(miss(4, 9, 0), 20);
  f.set_places(
      {{{0, 0.1f, 0.1f}, {0, 0.1f, 0.1f}, {-0.9f, 1, -0.9f}, {-0.6f, 1, -0.6f}, {}}, {{2, 2, 2}, {1, 2, 2}, {0, 3, 0}, {0, 3, 0}, {}}, 4});
  write_picture(tmp.folder / "x.exr", f, picture_kind::layers);
  auto channels = exr_channels(tmp.folder / "x.exr");
  using values = std::vector<float>;
  CHECK(channels["voxel.x"] == values{2, 1, 0, 0, -1});
  CHECK(channels["voxel.y"] == values{2, 2, 3, 3, -1});
  CHECK(channels["voxel.z"] == values{2, 2, 0, 0, -1});
  CHECK(channels["position.y"] == values{0.1f, 0.1f, 1, 1, 0});

  write_picture(tmp.folder / "x.model.png", f, picture_kind::model);
  const auto pixels = png_pixels(tmp.folder / "x.model.png");
  CHECK(pixels[2] == pixels[3]);
  CHECK(pixels[0] != pixels[1]);
  CHECK(pixels[1] != pixels[2]);
  CHECK(pixels[4] == background);
}

TEST_CASE("pictures: triangles by their number, normal and distance") {
  const scratch tmp;
  frame f({3, 1}, 0, true);
  f.store(hit(0, 1, no_axis, 0, 9, 0), 20, {1.5f, {0, 0.6f, -0.8f}, 47000});
  f.store(hit(1, 1, no_axis, 0, 9, 0), 20, {2.5f, {0, 0.6f, 0.8f}, 3});
  f.store(miss(2, 9, 0), 20, {});
  write_picture(tmp.folder / "x.exr", f, picture_kind::layers);
  auto channels = exr_channels(tmp.folder / "x.exr");
  using values = std::vector<float>;
  CHECK(channels.size() == 21);
  CHECK(channels["triangle"] == values{47000, 3, -1});
  CHECK(channels["normal.z"] == values{-0.8f, 0.8f, 0});
  CHECK(channels["depth"] == values{1.5f, 2.5f, 0});
  write_picture(tmp.folder / "x.model.png", f, picture_kind::model);
  const auto pixels = png_pixels(tmp.folder / "x.model.png");
  CHECK(pixels[0] != pixels[1]);
  CHECK(pixels[2] == background);
}

TEST_CASE("pictures: the sky is narrow in a corner, open on a plane, and needs a raster") {
  const scratch tmp;
  // A floor up to column 32, from there on a wall that rises from its edge.
  frame f({64, 64}, 16);
  frame::places where;
  const float step = 0.02f;
  for (std::uint32_t i = 0; i < 64 * 64; ++i) {
    const auto x = static_cast<float>(i % 64), z = static_cast<float>(i / 64);
    f.store(i % 64 < 32 ? hit(i, 1, 1, 1, 9, 0) : hit(i, 1, 0, -1, 9, 0), 20);
    where.points.push_back({std::min(x, 32.0f) * step, std::max(0.0f, x - 32) * step, z * step});
  }
  f.set_places(where);
  write_picture(tmp.folder / "x.exr", f, picture_kind::layers);
  const auto open = exr_channels(tmp.folder / "x.exr")["ambient"];
  const auto row = std::size_t{32} * 64;
  CHECK(open[row + 5] > 0.99f);
  CHECK(open[row + 30] < 0.85f);
  CHECK(open[row + 34] < 0.85f);
  CHECK(open[row + 60] > 0.99f);
  CHECK(open[row + 24] > open[row + 30]);

  // The same points in no order.
  for (std::size_t i = 0; i < where.points.size(); ++i) where.points[i] = where.points[i * 1027 % where.points.size()];
  f.set_places(where);
  write_picture(tmp.folder / "y.exr", f, picture_kind::layers);
  CHECK(exr_channels(tmp.folder / "y.exr")["ambient"] == std::vector<float>(64 * 64, 1));
}

TEST_CASE("pictures: the contact sheet of a small frame") {
  const scratch tmp;
  write_picture(tmp.folder / "x.sheet.png", small_frame(), picture_kind::sheet, {"a model", "6 rays"});
  const auto in = OIIO::ImageInput::open((tmp.folder / "x.sheet.png").string());
  REQUIRE(in);
  const auto width = static_cast<std::size_t>(in->spec().width), height = static_cast<std::size_t>(in->spec().height);
  CHECK(width == 1552);  // three panels of 480 and what lies around them
  CHECK(height > 3 * 320 + 300);
  CHECK(height < 3 * 320 + 600);
  const auto pixels = png_pixels(tmp.folder / "x.sheet.png");
  const auto at = [&](std::size_t x, std::size_t y) { return pixels[y * width + x]; };
  CHECK(at(2, 2) == rgb{255, 255, 255});
  // The second panel of the first row shows normals, 160 pixels for each.
  CHECK(at(536 + 80, 142 + 80) == rgb{0, 127, 127});
  CHECK(at(536 + 240, 142 + 80) == rgb{127, 255, 127});
  CHECK(at(536 + 400, 142 + 240) == rgb{0, 0, 0});
  // And there is ink in the headline, and under each panel.
  const auto darkest = [&](std::size_t x, std::size_t y, std::size_t columns, std::size_t rows) {
    int least = 255;
    for (std::size_t i = 0; i < columns * rows; ++i) least = std::min(least, at(x + i % columns, y + i / columns)[1]);
    return least;
  };
  CHECK(darkest(28, 28, 100, 22) < 60);
  for (const std::size_t x : {28, 536, 1044}) CHECK(darkest(x, 142 + 320 + 10, 200, 40) < 150);

  const std::string first = bytes_of(tmp.folder / "x.sheet.png");
  write_picture(tmp.folder / "x.sheet.png", small_frame(), picture_kind::sheet, {"a model", "6 rays"});
  CHECK(bytes_of(tmp.folder / "x.sheet.png") == first);
  write_picture(tmp.folder / "x.sheet.png", small_frame(), picture_kind::sheet, {"another", "6 rays"});
  CHECK(bytes_of(tmp.folder / "x.sheet.png") != first);
}

TEST_CASE("pictures: contact sheets of odd frames and long or broken names") {
  const scratch tmp;
  const picture_text texts[] = {{}, {std::string(500, 'W'), "\xff\xfe\n\t\xc3"}, {"\xe2\x89\xa5", std::string(300, '\xc3')}};
  const raster sizes[] = {{1, 1}, {3000, 1}, {1, 3000}};
  for (std::size_t k = 0; k < 3; ++k) {
    frame f(sizes[k], 16);
    for (std::uint32_t i = 0; i < f.pixels().size(); i += 2) f.store(hit(i, 1 + i, 1, 1, i, static_cast<std::uint16_t>(i % 99)), 10 + i);
    write_picture(tmp.folder / "x.sheet.png", f, picture_kind::sheet, texts[k]);
    CHECK(OIIO::ImageInput::open((tmp.folder / "x.sheet.png").string())->spec().width == 1552);
  }
}

TEST_CASE("pictures: the same frame gives the same bytes, without a date") {
  const scratch tmp;
  frame f({70, 150}, 16);  // more rows than a band
  for (std::uint32_t i = 0; i < 70 * 150; ++i) f.store(hit(i, i / 1000.0, static_cast<std::int8_t>(i % 3), 1, i % 99, 0), i);
  for (const char* name : {"x.png", "x.depth.png", "x.cost.png", "x.lit.png", "x.wait.png", "x.core.png", "x.sheet.png", "x.exr"}) {
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
  for (const char* name : {"x.png", "x.depth.png", "x.sheet.png", "x.exr"})
    for (const rlim_t bytes : {0, 10, 200}) {
      const rlimit tight{bytes, old.rlim_max};
      setrlimit(RLIMIT_FSIZE, &tight);
      try {
        write_picture(tmp.folder / name, f, kind_of(name));
        survived.push_back(name + (' ' + std::to_string(bytes)));
      } catch (const input_error&) {}
      setrlimit(RLIMIT_FSIZE, &old);
    }
  std::signal(SIGXFSZ, old_handler);
  CHECK(survived == std::vector<std::string>{});
  CHECK(fs::is_empty(tmp.folder));
}
