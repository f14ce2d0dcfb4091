#include "testbench/pictures/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <catch2/catch.hpp>

#include "testbench/tests/picture_reading.h"
#include "testbench/tests/scratch.h"

// The colours and layers of frames whose hits are known, from formulas written down once more.
namespace rtusim {
namespace {

using test::bytes_of_colour;
using test::png;
using test::read_layers;
using test::rgb;
using vec = std::array<double, 3>;
using values = std::vector<float>;

constexpr rgb background{236, 237, 240};

voxel_result voxel_hit(std::uint32_t pixel, int axis, int sign, double t = 1, std::uint32_t cost = 9) {
  voxel_result r;
  r.job_word = pixel;
  r.cost = cost;
  r.t_hit = static_cast<std::int64_t>(t * 65536);
  r.hit = true;
  r.normal_axis = static_cast<std::int8_t>(axis);
  r.normal_sign = static_cast<std::int8_t>(sign);
  return r;
}

voxel_result miss(std::uint32_t pixel, std::uint32_t cost = 9) {
  voxel_result r;
  r.job_word = pixel;
  r.cost = cost;
  return r;
}

/// Faces to all six sides, x in the first row, y in the second, z in the third; to the lower side first.
frame six_faces() {
  frame f({2, 3}, 16);
  for (std::uint32_t i = 0; i < 6; ++i) f.store(voxel_hit(i, static_cast<int>(i / 2), i % 2 == 0 ? -1 : 1), 20);
  return f;
}

/// Triangles with these normals, in one row.
frame triangles_of(const std::vector<std::array<float, 3>>& normals, const std::vector<std::uint32_t>& faces = {}) {
  frame f({static_cast<unsigned>(normals.size()), 1}, 0, true);
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    voxel_result r = miss(i);
    r.hit = true;
    f.store(r, 20, {1.0f, normals[i], faces.empty() ? i : faces[i]});
  }
  return f;
}

vec normalised(const vec& v) {
  const double length = std::hypot(std::hypot(v[0], v[1]), v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// The light falls from above and from the left of one who looks against the mean of the horizontal parts of the normals.
vec light_for(double toward_x, double toward_z) {
  const double length = std::hypot(toward_x, toward_z), x = toward_x / length, z = toward_z / length;
  return normalised({0.6 * (x - z), 0.8, 0.6 * (z + x)});
}

/// Sun, and sky and ground, on clay, in linear light.
vec lit(const vec& n, const vec& light, double open = 1) {
  const vec clay{0.80, 0.72, 0.62}, sun{0.98, 0.93, 0.84}, sky{0.30, 0.34, 0.40}, ground{0.13, 0.12, 0.11};
  const double facing = n[0] * light[0] + n[1] * light[1] + n[2] * light[2];
  vec c{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double around = sky[i] * (1 + n[1]) / 2 + ground[i] * (1 - n[1]) / 2;
    c[i] = std::min(1.0, clay[i] * ((facing > 0 ? facing * sun[i] * (1 + open) / 2 : 0) + around * open));
  }
  return c;
}

void check_lit(const test::layers& channels, std::size_t pixel, const vec& expected) {
  CAPTURE(pixel);
  const char* const names[] = {"lit.R", "lit.G", "lit.B"};
  for (std::size_t i = 0; i < 3; ++i) CHECK(channels.at(names[i]).at(pixel) == Approx(expected[i]).epsilon(1e-4));
}

/// Of Okabe and Ito by a number's hash (the finaliser of MurmurHash3), a quarter of them darker and a quarter lighter.
rgb hashed(std::uint64_t n) {
  n ^= n >> 33;
  n *= 0xff51afd7ed558ccdu;
  n ^= n >> 33;
  n *= 0xc4ceb9fe1a85ec53u;
  n ^= n >> 33;
  constexpr double colours[8][3] = {{230, 159, 0}, {86, 180, 233}, {0, 158, 115},   {240, 228, 66},
                                    {0, 114, 178}, {213, 94, 0},   {204, 121, 167}, {136, 136, 136}};
  const double* c = colours[n & 7];
  const auto shade = (n >> 8) % 4;
  rgb shown{};
  for (std::size_t i = 0; i < 3; ++i) shown[i] = static_cast<int>(shade == 0 ? 0.7 * c[i] : shade == 1 ? 0.55 * c[i] + 0.45 * 255 : c[i]);
  return shown;
}

png written(const test::scratch_folder& tmp, const frame& f, const char* word) {
  const auto file = tmp / ("x" + std::string(word) + ".png");
  write_picture(file, f, kind_of(file));
  return png(file);
}

test::layers layers_of(const test::scratch_folder& tmp, const frame& f) {
  write_picture(tmp / "x.exr", f, picture_kind::layers);
  return read_layers(tmp / "x.exr");
}

}  // namespace

TEST_CASE("picture values: voxel faces to both sides of each axis") {
  const test::scratch_folder tmp;
  const frame f = six_faces();
  CHECK(written(tmp, f, "").pixels ==
        std::vector<rgb>{{178, 178, 178}, {178, 178, 178}, {229, 229, 229}, {229, 229, 229}, {127, 127, 127}, {127, 127, 127}});
  CHECK(written(tmp, f, ".normal").pixels ==
        std::vector<rgb>{{0, 127, 127}, {255, 127, 127}, {127, 0, 127}, {127, 255, 127}, {127, 127, 0}, {127, 127, 255}});
  auto channels = layers_of(tmp, f);
  CHECK(channels["normal.x"] == values{-1, 1, 0, 0, 0, 0});
  CHECK(channels["normal.y"] == values{0, 0, -1, 1, 0, 0});
  CHECK(channels["normal.z"] == values{0, 0, 0, 0, -1, 1});
  CHECK(channels["hit"] == values{1, 1, 1, 1, 1, 1});
}

TEST_CASE("picture values: triangles shaded by a light from above, normals as colours") {
  const test::scratch_folder tmp;
  const frame f = triangles_of(
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0.6f, -0.8f}, {-0.8f, 0, 0.6f}, {0.4f, 0.8f, 0.447f}});
  // 0.2 + 0.75 (0.4 x + 0.8 y + 0.45 z + 1) / 2 of 255
  const int greys[] = {184, 108, 223, 70, 189, 103, 158, 141, 242};
  const auto shaded = written(tmp, f, ""), by_cost = written(tmp, f, ".cost"), normal = written(tmp, f, ".normal");
  const auto red = layers_of(tmp, f)["R"];
  for (std::size_t i = 0; i < 9; ++i) {
    CAPTURE(i);
    CHECK(shaded.pixels[i] == rgb{greys[i], greys[i], greys[i]});
    CHECK(by_cost.pixels[i] == shaded.pixels[i]);
    const double light = (greys[i] + 0.5) / 255;
    CHECK(red[i] == Approx(std::pow((light + 0.055) / 1.055, 2.4)).epsilon(0.02));
  }
  const std::vector<rgb> expected{{255, 127, 127}, {0, 127, 127},  {127, 255, 127}, {127, 0, 127},  {127, 127, 255},
                                  {127, 127, 0},   {127, 204, 25}, {25, 127, 204},  {178, 229, 184}};
  for (std::size_t i = 0; i < 9; ++i) CHECK(normal.pixels[i] == expected[i]);
}

TEST_CASE("picture values: the light comes from above the eye's left and lights what faces it") {
  const test::scratch_folder tmp;
  const struct {
    double toward_x, toward_z;  // where the eye is
  } eyes[] = {{-1, 0}, {1, 0}, {0, 1}, {0, -1}, {0.6, -0.8}};
  for (const auto& eye : eyes) {
    CAPTURE(eye.toward_x, eye.toward_z);
    const vec light = light_for(eye.toward_x, eye.toward_z);
    const auto x = static_cast<float>(eye.toward_x), z = static_cast<float>(eye.toward_z);
    const std::array<float, 3> to_light{static_cast<float>(light[0]), static_cast<float>(light[1]), static_cast<float>(light[2])};
    // To the eye, its left, its right, up, down, to the light and away from it: sideways they cancel out.
    const std::vector<std::array<float, 3>> normals{
        {x, 0, z}, {-z, 0, x}, {z, 0, -x}, {0, 1, 0}, {0, -1, 0}, to_light, {-to_light[0], -to_light[1], -to_light[2]}};
    const frame f = triangles_of(normals);
    const auto channels = layers_of(tmp, f);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const auto& n = normals[i];
      check_lit(channels, i, lit({static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}, light));
    }
    const auto& green = channels.at("lit.G");
    CHECK(green[1] > green[2]);
    CHECK(*std::max_element(green.begin(), green.end()) == green[5]);
    const auto shown = written(tmp, f, ".lit");
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const auto srgb = [](float v) { return std::pow(static_cast<double>(v), 1 / 2.4) * 1.055 - 0.055; };
      CHECK(test::near(shown.pixels[i], bytes_of_colour(srgb(channels.at("lit.R")[i]), srgb(green[i]), srgb(channels.at("lit.B")[i]))));
    }
  }
}

TEST_CASE("picture values: seen straight from above the light comes as if the eye were in front", "[pictures]") {
  const test::scratch_folder tmp;
  const auto channels = layers_of(tmp, triangles_of({{0, 1, 0}, {0, 1, 0}}));
  const vec light = light_for(0, 1);
  for (std::size_t i = 0; i < 2; ++i) check_lit(channels, i, lit({0, 1, 0}, light));
}

TEST_CASE("picture values: lit voxel faces, misses and pixels without a result") {
  const test::scratch_folder tmp;
  frame f({5, 1}, 16);
  f.store(voxel_hit(0, 0, -1), 20);
  f.store(voxel_hit(1, 1, 1), 20);
  f.store(voxel_hit(2, 1, -1), 20);
  f.store(miss(3), 20);
  const auto channels = layers_of(tmp, f);
  const vec light = light_for(-1, 0);
  check_lit(channels, 0, lit({-1, 0, 0}, light));
  check_lit(channels, 1, lit({0, 1, 0}, light));
  check_lit(channels, 2, lit({0, -1, 0}, light));
  check_lit(channels, 4, {0, 0, 0});
  const auto shown = written(tmp, f, ".lit");
  CHECK(shown.pixels[3] == background);
  CHECK(shown.pixels[4] == rgb{0, 0, 0});
  CHECK(channels.at("R")[3] == 1);
  CHECK(channels.at("ambient") == values{1, 1, 1, 1, 1});
  // Without a normal to the side it comes along z.
  frame floor({1, 1}, 16);
  floor.store(voxel_hit(0, 1, 1), 20);
  check_lit(layers_of(tmp, floor), 0, lit({0, 1, 0}, light_for(0, 1)));
}

TEST_CASE("picture values: small voxels are rounded, large ones show their faces") {
  const test::scratch_folder tmp;
  // Two faces side by side in the picture, `wide` pixels a voxel: too flat for their sky to be narrow.
  for (const double wide : {2.0, 3.0, 4.0, 5.5, 8.0, 10.0}) {
    CAPTURE(wide);
    frame f({2, 1}, 16);
    f.store(voxel_hit(0, 0, -1), 20);
    f.store(voxel_hit(1, 1, 1), 20);
    const double edge = 0.02;
    f.set_places({{{0, 0, 0}, {static_cast<float>(edge / wide), 0, 0}}, {{0, 0, 0}, {0, 0, 0}}, 100});
    const double rounded = 0.8 * std::clamp((8 - wide) / 5, 0.0, 1.0);
    const double weight = 1 - 1 / (9 * wide * wide);  // of the neighbour, beside 1 of its own
    const vec mean = normalised({-1, weight, 0}), own = normalised({-1 + rounded * (mean[0] + 1), rounded * mean[1], 0});
    const auto channels = layers_of(tmp, f);
    REQUIRE(channels.at("ambient") == values{1, 1});
    const vec light = light_for(-1, 0);
    check_lit(channels, 0, lit(own, light));
    check_lit(channels, 1, lit({own[1] * -1, -own[0], 0}, light));
  }
}

TEST_CASE("picture values: the sky at a corner is that of the method's integral") {
  const test::scratch_folder tmp;
  // A floor up to column 32, from there on a wall that rises from its edge; triangles, so that nothing is rounded.
  constexpr double step = 0.02, reach = 0.22, radius = 11;  // pixels
  const auto point = [](double x, double z) { return vec{std::min(x, 32.0) * step, std::max(0.0, x - 32) * step, z * step}; };
  for (const bool tall : {true, false}) {
    frame f({64, 64}, 0, true);
    frame::places where;
    for (std::uint32_t i = 0; i < 64 * 64; ++i) {
      voxel_result r = miss(i);
      r.hit = true;
      f.store(r, 20, {1.0f, i % 64 < 32 ? std::array<float, 3>{0, 1, 0} : std::array<float, 3>{-1, 0, 0}, i});
      const vec p = point(i % 64, i / 64);
      where.points.push_back(
          {static_cast<float>(p[0]), static_cast<float>(p[1] + (tall || i % 64 < 32 ? 0 : reach)), static_cast<float>(p[2])});
    }
    f.set_places(where);
    const auto channels = layers_of(tmp, f);
    const auto& open = channels.at("ambient");
    const auto row = std::size_t{32} * 64;
    // Of the sun half comes on where no sky is left, of the sky's own light none.
    for (const std::size_t x : {std::size_t{20}, std::size_t{28}, std::size_t{30}, std::size_t{34}})
      check_lit(channels, row + x, lit(x < 32 ? vec{0, 1, 0} : vec{-1, 0, 0}, light_for(-1, 0), static_cast<double>(open[row + x])));
    if (!tall) {  // what is further than the reach takes nothing
      for (std::size_t x = 0; x < 28; ++x) CHECK(open[row + x] == 1);
      continue;
    }
    // McGuire, Mara, Luebke 2012, eq. 1 as the mean over a disc whose radius is told evenly; taps are as far as a pixel at least.
    const auto narrowed = [&](double x) {
      double sum = 0;
      constexpr int rings = 220, angles = 240;
      for (int i = 0; i < rings; ++i)
        for (int j = 0; j < angles; ++j) {
          const double away = std::max(1.0, (i + 0.5) / rings * radius), angle = 2 * 3.14159265358979 * (j + 0.5) / angles;
          const vec from = point(x, 32), to = point(std::round(x + away * std::cos(angle)), std::round(32 + away * std::sin(angle)));
          const double dx = to[0] - from[0], dy = to[1] - from[1], dz = to[2] - from[2], square = dx * dx + dy * dy + dz * dz;
          if (square >= reach * reach) continue;
          sum += std::pow(1 - square / reach / reach, 3) * std::max(0.0, dy - step) * reach / (square + 0.01 * reach * reach);
        }
      return 0.65 * 5 * sum / (rings * angles);
    };
    for (const int x : {20, 24, 26, 28, 30}) {
      CAPTURE(x);
      double mean = 0;
      int count = 0;
      for (int near = x - 2; near < x + 2 && near < 32; ++near, ++count) mean += narrowed(near);
      mean /= count;
      CHECK(1 - open[row + static_cast<std::size_t>(x)] == Approx(mean).epsilon(0.06).margin(0.003));
    }
    CHECK(1 - open[row + 30] > 0.1f);
    for (std::size_t x = 1; x < 22; ++x) CHECK(open[row + x] >= open[row + x + 10]);
  }
}

TEST_CASE("picture values: depth falls in a line from the nearest hit's grey to the farthest's") {
  const test::scratch_folder tmp;
  frame f({7, 1}, 16);
  const double depths[] = {4.75, 1.25, 2, 3.5, 4.25};
  for (std::uint32_t i = 0; i < 5; ++i) f.store(voxel_hit(i, 1, 1, depths[i]), 20);
  f.store(miss(5), 20);
  const png shown = written(tmp, f, ".depth");
  for (std::size_t i = 0; i < 5; ++i) {
    const double grey = 0.95 - 0.80 * (depths[i] - 1.25) / 3.5;
    CHECK(test::near(shown.pixels[i], bytes_of_colour(grey, grey, grey)));
  }
  CHECK(shown.pixels[5] == bytes_of_colour(0.08, 0.12, 0.30));
  CHECK(shown.pixels[6] == rgb{0, 0, 0});
  CHECK(shown.description == "Depth: colours from 1.25 to 4.75 world units");
}

TEST_CASE("picture values: a miss is the redder, the more it cost, and white at least") {
  const test::scratch_folder tmp;
  frame f({9, 1}, 16);
  const std::uint32_t costs[] = {1, 2, 3, 4, 22, 42, 122, 500};
  for (std::uint32_t i = 0; i < 8; ++i) f.store(miss(i, costs[i]), 20);
  const png shown = written(tmp, f, ".cost");
  for (std::size_t i = 0; i < 8; ++i) {
    const double rest = std::min(1.0, std::pow(0.95, (costs[i] - 2.0) / 2));
    CHECK(test::near(shown.pixels[i], bytes_of_colour(1, rest, rest), 0));
  }
  CHECK(shown.pixels[3] == rgb{255, 242, 242});
  CHECK(shown.pixels[8] == rgb{0, 0, 0});
  CHECK(shown.description == "Cost of misses: colours from 2 to 122 cycles and more");
  // Hits have no say in where the scale ends, and it ends at 122 at the latest.
  const struct {
    std::uint32_t hit_cost, miss_cost;
    const char* told;
  } scales[] = {{500, 50, "Cost of misses: colours from 2 to 50 cycles"},
                {9, 121, "Cost of misses: colours from 2 to 121 cycles"},
                {9, 122, "Cost of misses: colours from 2 to 122 cycles"},
                {9, 123, "Cost of misses: colours from 2 to 122 cycles and more"}};
  for (const auto& s : scales) {
    frame g({2, 1}, 16);
    g.store(voxel_hit(0, 0, 1, 1, s.hit_cost), 20);
    g.store(miss(1, s.miss_cost), 20);
    CHECK(written(tmp, g, ".cost").description == s.told);
  }
}

TEST_CASE("picture values: each pixel's place on the scales of cost, latency and wait") {
  const test::scratch_folder tmp;
  // The scales as OpenImageIO has them, at shares of their length that 255 steps hit.
  const auto scale = [](const char* name, double share) {
    OIIO::ImageBuf one(OIIO::ImageSpec(1, 1, 1, OIIO::TypeDesc::FLOAT));
    const auto value = static_cast<float>(share);
    one.setpixel(0, 0, &value);
    const OIIO::ImageBuf shown = OIIO::ImageBufAlgo::color_map(one, 0, name, {}, 1);
    std::array<float, 3> light{};
    shown.getpixel(0, 0, light.data(), 3);
    std::array<double, 3> c{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double v = static_cast<double>(light[i]);
      c[i] = v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    }
    return bytes_of_colour(c[0], c[1], c[2]);
  };
  // Costs from 10 to 265, latencies from 400 to 655, waits from 100 to 355, by three orders.
  frame f({256, 1}, 16);
  f.set_way(17);
  const auto cost = [](std::uint32_t i) { return 10 + i; };
  const auto wait = [](std::uint32_t i) { return 100 + i * 89 % 256; };
  for (std::uint32_t i = 0; i < 256; ++i) f.store(i % 2 == 0 ? miss(i, cost(i)) : voxel_hit(i, 0, 1, 1, cost(i)), 17 + cost(i) + wait(i));
  const png heat = written(tmp, f, ".heat"), latency = written(tmp, f, ".latency"), waits = written(tmp, f, ".wait");
  std::uint32_t least = ~0u, most = 0;
  for (std::uint32_t i = 0; i < 256; ++i) {
    least = std::min(least, 17 + cost(i) + wait(i));
    most = std::max(most, 17 + cost(i) + wait(i));
  }
  for (std::uint32_t i = 0; i < 256; ++i) {
    CAPTURE(i);
    CHECK(test::near(heat.pixels[i], scale("inferno", i / 255.0)));
    CHECK(test::near(waits.pixels[i], scale("viridis", (wait(i) - 100) / 255.0)));
    CHECK(test::near(latency.pixels[i], scale("viridis", std::round(255.0 * (17 + cost(i) + wait(i) - least) / (most - least)) / 255)));
  }
  CHECK(heat.description == "Cost: colours from 10 to 265 cycles");
  CHECK(waits.description == "Wait: colours from 100 to 355 cycles");
  CHECK(latency.description == "Latency: colours from " + std::to_string(least) + " to " + std::to_string(most) + " cycles");
}

TEST_CASE("picture values: a wait is what latency has beyond cost and way, never below 0") {
  const test::scratch_folder tmp;
  frame f({4, 1}, 16);
  f.set_way(10);
  f.store(voxel_hit(0, 0, 1, 1, 5), 22);
  f.store(miss(1, 5), 15);
  f.store(miss(2, 5), 14);
  f.store(miss(3, 40), 3);
  CHECK(layers_of(tmp, f)["wait"] == values{7, 0, 0, 0});
  CHECK(written(tmp, f, ".wait").description == "Wait: colours from 0 to 7 cycles");
}

TEST_CASE("picture values: where a scale is cut, and how its ends are told") {
  const test::scratch_folder tmp;
  const auto told = [&](std::uint32_t rays, std::uint32_t dearer, std::uint32_t greatest) {
    frame f({rays, 1}, 16);
    for (std::uint32_t i = 0; i < rays; ++i) f.store(miss(i, i < dearer ? greatest : i == dearer ? 100 : 20), 20);
    return written(tmp, f, ".heat").description;
  };
  // Of 1000 rays 995 lie within the usual, which is 100; beyond 20 + 1.25 * 80 it is cut.
  CHECK(told(1000, 5, 120) == "Cost: colours from 20 to 120 cycles");
  CHECK(told(1000, 5, 121) == "Cost: colours from 20 to 100 cycles and more");
  CHECK(told(1000, 6, 121) == "Cost: colours from 20 to 121 cycles");
  CHECK(told(1000, 4, 121) == "Cost: colours from 20 to 121 cycles");  // the usual is the least
  CHECK(told(1000, 5, 12'345'678) == "Cost: colours from 20 to 100 cycles and more");
  CHECK(told(2, 1, 12'345'678) == "Cost: colours from 100 to 12,345,678 cycles");

  const struct {
    double near, far;
    const char* told;
  } depths[] = {{0.125, 1234.5, "Depth: colours from 0.125 to 1,234 world units"},
                {3, 1000, "Depth: colours from 3 to 1,000 world units"},
                {-3.5, 0.333251953125, "Depth: colours from -3.5 to 0.3333 world units"},
                {-2048, 999.5, "Depth: colours from -2,048 to 999.5 world units"}};
  for (const auto& d : depths) {
    frame f({2, 1}, 16);
    f.store(voxel_hit(0, 0, 1, d.far), 20);
    f.store(voxel_hit(1, 0, 1, d.near), 20);
    CHECK(written(tmp, f, ".depth").description == d.told);
  }
  frame f({1, 1}, 16);
  f.store(miss(0), 20);
  for (const char* word : {"", ".lit", ".normal", ".core", ".model"}) CHECK(written(tmp, f, word).description.empty());
  CHECK(written(tmp, f, ".depth").description == "Depth: colours from 0 to 0 world units");
}

TEST_CASE("picture values: voxels by the 32nd of the cube they lie in, triangles by their face") {
  const test::scratch_folder tmp;
  const std::array<std::uint32_t, 3> voxels[] = {{0, 0, 0}, {127, 127, 127}, {3, 3, 3}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {7, 9, 20}};
  const std::uint64_t parts[] = {0, 31 * 1024 + 31 * 32 + 31, 0, 1, 32, 1024, 5 * 1024 + 2 * 32 + 1};
  frame f({7, 1}, 16);
  frame::places where;
  where.cells = 128;
  for (std::uint32_t i = 0; i < 7; ++i) {
    f.store(voxel_hit(i, 0, 1), 20);
    where.voxels.push_back(voxels[i]);
    where.points.emplace_back();
  }
  f.set_places(where);
  const png shown = written(tmp, f, ".model");
  for (std::size_t i = 0; i < 7; ++i) CHECK(test::near(shown.pixels[i], hashed(parts[i])));
  // Of a coarse model each voxel for itself.
  where.cells = 16;
  where.voxels.assign(7, {3, 2, 1});
  f.set_places(where);
  CHECK(test::near(written(tmp, f, ".model").pixels[4], hashed(1024 + 2 * 32 + 3)));

  const std::vector<std::uint32_t> faces{0, 1, 2, 47000, 3, 1'000'000, 8};
  const png by_face = written(tmp, triangles_of(std::vector<std::array<float, 3>>(7, {0, 1, 0}), faces), ".model");
  for (std::size_t i = 0; i < 7; ++i) CHECK(test::near(by_face.pixels[i], hashed(faces[i])));
}

TEST_CASE("picture values: every one of 16 cores has its colour") {
  const test::scratch_folder tmp;
  const rgb bright[] = {{230, 159, 0}, {86, 180, 233}, {0, 158, 115},   {240, 228, 66},
                        {0, 114, 178}, {213, 94, 0},   {204, 121, 167}, {136, 136, 136}};
  frame f({32, 1}, 16);
  for (std::uint32_t i = 0; i < 32; ++i) {
    voxel_result r = i % 3 == 0 ? miss(i) : voxel_hit(i, 0, 1);
    r.core = static_cast<std::uint16_t>(i);
    f.store(r, 20);
  }
  const png shown = written(tmp, f, ".core");
  for (std::size_t i = 0; i < 32; ++i) {
    CAPTURE(i);
    const rgb& c = bright[i % 8];
    CHECK(test::near(shown.pixels[i], i % 16 < 8 ? c : rgb{c[0] / 2, c[1] / 2, c[2] / 2}));
  }
}

TEST_CASE("picture values: all layers of triangles") {
  const test::scratch_folder tmp;
  frame f({2, 2}, 0, true);
  f.set_way(6);
  voxel_result r = miss(2, 33);
  r.hit = true;
  r.core = 5;
  f.store(r, 44, {2.25f, {0.6f, 0, 0.8f}, 7});
  f.store(miss(1, 12), 18, {});
  f.store(miss(0, 4), 90, {});
  f.set_places({{{}, {}, {0.25f, -0.5f, 0.75f}, {}}, {}, 0});
  auto channels = layers_of(tmp, f);
  CHECK(channels["hit"] == values{0, 0, 1, 0});
  CHECK(channels["depth"] == values{0, 0, 2.25f, 0});
  CHECK(channels["normal.x"] == values{0, 0, 0.6f, 0});
  CHECK(channels["normal.y"] == values{0, 0, 0, 0});
  CHECK(channels["normal.z"] == values{0, 0, 0.8f, 0});
  CHECK(channels["cost"] == values{4, 12, 33, 0});
  CHECK(channels["core"] == values{0, 0, 5, -1});
  CHECK(channels["latency"] == values{90, 18, 44, 0});
  CHECK(channels["wait"] == values{80, 0, 5, 0});
  CHECK(channels["position.x"] == values{0, 0, 0.25f, 0});
  CHECK(channels["position.y"] == values{0, 0, -0.5f, 0});
  CHECK(channels["position.z"] == values{0, 0, 0.75f, 0});
  CHECK(channels["model"] == values{-1, -1, 0, -1});
  CHECK(channels["triangle"] == values{-1, -1, 7, -1});
}

}  // namespace rtusim
