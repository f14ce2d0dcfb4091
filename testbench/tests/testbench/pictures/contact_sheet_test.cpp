#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "testbench/pictures/pictures.h"
#include "testbench/tests/picture_reading.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

// What stands where on a contact sheet: each map's panel against the picture of that kind, legends against what they tell.
namespace rtusim {
namespace {

namespace algo = OIIO::ImageBufAlgo;
using test::near;
using test::png;
using test::rgb;

constexpr std::size_t margin = 28, panel_width = 480, apart = 508, first_panel = 142;
const char* const kinds[] = {"lit", "normal", "depth", "heat", "latency", "wait", "cost", "core", "model"};
constexpr rgb border{96, 100, 108}, background{236, 237, 240};

/// Hits of all axes and misses, with numbers in no order; a pixel without a result.
frame mixed_frame(unsigned width, unsigned height) {
  test::rng random(7);
  frame f({width, height}, 16);
  f.set_way(10);
  frame::places where;
  where.cells = 4;
  for (std::uint32_t i = 0; i < width * height; ++i) {
    where.points.emplace_back();
    where.voxels.push_back(
        {static_cast<std::uint32_t>(random() % 4), static_cast<std::uint32_t>(random() % 4), static_cast<std::uint32_t>(random() % 4)});
    if (i == width + 1) continue;
    voxel_result r;
    r.job_word = i;
    r.hit = random() % 3 != 0;
    r.cost = static_cast<std::uint32_t>(2 + random() % 57);
    r.t_hit = static_cast<std::int64_t>(65536 + random() % 131072);
    r.core = static_cast<std::uint16_t>(random() % 6);
    r.normal_axis = static_cast<std::int8_t>(random() % 3);
    r.normal_sign = random() % 2 == 0 ? 1 : -1;
    f.store(r, 10 + r.cost + random() % 40);
  }
  f.set_places(where);
  return f;
}

struct sheet_of {
  test::scratch_folder tmp;
  png sheet;
  std::vector<png> maps;

  explicit sheet_of(const frame& f, const picture_text& text = {"a model", "some rays"}) : sheet(written(f, "sheet", text)) {
    for (const char* kind : kinds) maps.push_back(written(f, kind, {}));
  }
  png written(const frame& f, const char* kind, const picture_text& text) const {
    const auto file = tmp / fmt::format("x.{}.png", kind);
    write_picture(file, f, kind_of(file), text);
    return png(file);
  }
  static std::size_t left(std::size_t panel) { return margin + panel % 3 * apart; }

  /// Whether all of a map stands at a height, each of its pixels `zoom` wide.
  bool stands_at(std::size_t panel, std::size_t top, std::size_t zoom) const {
    const png& map = maps[panel];
    if (top + zoom * map.height > sheet.height) return false;
    for (std::size_t y = 0; y < map.height; ++y)
      for (std::size_t x = 0; x < map.width; ++x)
        for (const std::size_t at : {std::size_t{0}, zoom - 1})
          if (sheet.at(left(panel) + zoom * x + at, top + zoom * y + at) != map.at(x, y)) return false;
    return true;
  }
  /// Where it stands; none or several are a fault.
  std::size_t top_of(std::size_t panel, std::size_t zoom) const {
    std::vector<std::size_t> found;
    for (std::size_t y = 0; y < sheet.height; ++y)
      if (stands_at(panel, y, zoom)) found.push_back(y);
    CAPTURE(panel, found);
    REQUIRE(found.size() == 1);
    return found[0];
  }
  /// The colours of the legend's boxes in a line, from left to right.
  std::vector<rgb> boxes(std::size_t panel, std::size_t y) const {
    std::vector<rgb> all;
    for (std::size_t x = left(panel); x + 13 <= left(panel) + panel_width; ++x) {
      bool box = true;
      for (std::size_t i = 0; i < 13; ++i)
        box &= sheet.at(x, y + i) == border && sheet.at(x + 12, y + i) == border && sheet.at(x + i, y) == border &&
               sheet.at(x + i, y + 12) == border;
      if (box) all.push_back(sheet.at(x + 6, y + 6));
    }
    return all;
  }
  /// Whether a text stands with its base line there, on white, and nothing else around it.
  bool tells(std::size_t x, std::size_t base, const std::string& text, const char* font, int size, const rgb& ink, algo::TextAlignX align,
             std::size_t from_x, std::size_t past_x) const {
    const int rows = 40, line = 26;
    OIIO::ImageBuf paper(OIIO::ImageSpec(static_cast<int>(sheet.width), rows, 3, OIIO::TypeDesc::UINT8));
    algo::fill(paper, {1.0f, 1.0f, 1.0f}, {}, 1);
    const auto pen = [&](std::size_t i) { return static_cast<float>((ink[i] + 0.5) / 255.5); };
    const float shown[] = {pen(0), pen(1), pen(2)};
    algo::render_text(paper, static_cast<int>(x), line, text, size, fmt::format("/usr/share/fonts/truetype/dejavu/{}.ttf", font), shown,
                      align, algo::TextAlignY::Baseline, 0, {}, 1);
    for (int y = line - size / 2; y < line + 3; ++y)  // digits and letters in their middle
      for (std::size_t column = from_x; column < past_x; ++column) {
        std::array<float, 3> wanted{};
        paper.getpixel(static_cast<int>(column), y, wanted.data(), 3);
        const rgb& is = sheet.at(column, base + static_cast<std::size_t>(y) - line);
        for (std::size_t i = 0; i < 3; ++i)
          if (std::abs(is[i] - std::lround(wanted[i] * 255)) > 2) return false;
      }
    return true;
  }
};

constexpr rgb ink{28, 30, 34}, soft_ink{96, 100, 108};

}  // namespace

TEST_CASE("contact sheet: nine panels by their place, each the picture of its kind") {
  const sheet_of s(mixed_frame(48, 32));
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = i + 1; k < 9; ++k) REQUIRE(s.maps[i].pixels != s.maps[k].pixels);
  std::size_t before = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    const std::size_t top = s.top_of(3 * row, 10);
    CHECK(s.top_of(3 * row + 1, 10) == top);
    CHECK(s.top_of(3 * row + 2, 10) == top);
    if (row == 0) CHECK(top == first_panel);
    if (row > 0) CHECK(top > before + 320);
    before = top;
  }
}

TEST_CASE("contact sheet: legends tell a scale's colours, its ends and its middle, and what other colours mean") {
  frame f({30, 20}, 16);
  f.set_way(3);
  for (std::uint32_t i = 0; i < 600; ++i) {
    voxel_result r;
    r.job_word = i;
    r.hit = i >= 300;
    r.cost = i < 300 ? 2 + i % 81 : 5;  // misses up to 82
    r.t_hit = std::int64_t{1 + i % 4} << 16;
    r.core = static_cast<std::uint16_t>(i % 3);
    r.normal_axis = static_cast<std::int8_t>(i % 3);
    r.normal_sign = 1;
    f.store(r, 3 + r.cost + (i == 0 ? 0 : 1000));
  }
  const sheet_of s(f);
  const struct {
    std::size_t panel;
    rgb low, high;
    const char *least, *middle, *most, *figures;
  } scales[] = {
      {2, {242, 242, 242}, {38, 38, 38}, "1", "2.5", "4 world units", "the model's cube has an edge of 2"},
      {3, {0, 0, 3}, {252, 254, 164}, "2", "42", "82 cycles", "half within 5, 99 % within 80, all within 82"},
      {4, {68, 1, 84}, {253, 231, 36}, "5", "545", "1,085 cycles", "half within 1,008, 99 % within 1,083, all within 1,085"},
      {5, {68, 1, 84}, {253, 231, 36}, "0", "500", "1,000 cycles", "half within 1,000, 99 % within 1,000, all within 1,000"},
      {6, {255, 255, 255}, {255, 32, 32}, "2", "42", "82 cycles", "most expensive miss: 82 cycles"},
  };
  // 300 costs from 2 on in turns of 81 and 300 of 5: 316 of at most 5, 594 of at most 80.
  for (const auto& l : scales) {
    CAPTURE(l.panel);
    const std::size_t bar = s.top_of(l.panel, 16) + 320 + 10, left = s.left(l.panel), past = left + panel_width, base = bar + 27;
    for (std::size_t y = bar; y < bar + 12; ++y) {
      CHECK(near(s.sheet.at(left, y), l.low));
      CHECK(near(s.sheet.at(past - 1, y), l.high));
    }
    CHECK(s.sheet.at(left, bar - 1) == rgb{255, 255, 255});
    CHECK(s.sheet.at(left, bar + 12) == rgb{255, 255, 255});
    CHECK(s.tells(left, base, l.least, "DejaVuSans", 14, ink, algo::TextAlignX::Left, left, left + 100));
    CHECK(s.tells(left + 240, base, l.middle, "DejaVuSans", 14, ink, algo::TextAlignX::Center, left + 150, left + 330));
    CHECK(s.tells(past, base, l.most, "DejaVuSans", 14, ink, algo::TextAlignX::Right, past - 140, past));
    const std::size_t wide = std::string(l.figures).size() * 6;
    CHECK(s.tells(left, bar + 36 + 11, l.figures, "DejaVuSans", 13, soft_ink, algo::TextAlignX::Left, left, left + wide));
    CHECK_FALSE(s.tells(left, base, "7", "DejaVuSans", 14, ink, algo::TextAlignX::Left, left, left + 100));
  }
  const auto legend = [&](std::size_t panel, bool scale) { return s.boxes(panel, s.top_of(panel, 16) + 330 + (scale ? 36 : 0)); };
  CHECK(legend(0, false) == std::vector<rgb>{background});
  const auto all_are = [](const std::vector<rgb>& shown, const std::vector<rgb>& wanted) {
    REQUIRE(shown.size() == wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(near(shown[i], wanted[i]));
  };
  all_are(legend(1, false), {{255, 127, 127}, {0, 127, 127}, {127, 255, 127}, {127, 0, 127}, {127, 127, 255}, {127, 127, 0}, background});
  all_are(legend(2, true), {{20, 30, 76}});
  CHECK(legend(3, true).empty());
  all_are(legend(6, true), {{178, 178, 178}, {229, 229, 229}, {127, 127, 127}});
  CHECK(legend(7, false) == std::vector<rgb>{{230, 159, 0}, {86, 180, 233}, {0, 158, 115}});
  CHECK(legend(8, false) == std::vector<rgb>{background});
}

TEST_CASE("contact sheet: titles and headline") {
  const sheet_of s(mixed_frame(48, 32), {"dragon.svo, 32 voxels an edge", "6 rays in 7 cycles"});
  const char* const titles[] = {"Lit", "Normal", "Depth", "Cost", "Latency", "Wait", "Cost of misses", "Core", "Part of the model"};
  CHECK(s.tells(margin, 48, "dragon.svo, 32 voxels an edge", "DejaVuSans-Bold", 26, ink, algo::TextAlignX::Left, margin, 600));
  CHECK(s.tells(margin, 76, "6 rays in 7 cycles", "DejaVuSans", 17, soft_ink, algo::TextAlignX::Left, margin, 600));
  for (std::size_t i = 0; i < 9; ++i) {
    CAPTURE(titles[i]);
    const std::size_t left = s.left(i);
    CHECK(s.tells(left, s.top_of(i, 10) - 30, titles[i], "DejaVuSans-Bold", 18, ink, algo::TextAlignX::Left, left, left + panel_width));
  }
  const char* const sentences[] = {"What the rays hit, in light from the upper left; crevices are darker.",
                                   "Which way the surface faces: x in red, y (up) in green, z in blue.",
                                   "How far along its ray each hit lies.",
                                   "Cycles that a core worked on the ray, hit or miss.",
                                   "Cycles from the ray's arrival in the unit to its result.",
                                   "Of its latency, the cycles in which the ray stood in a queue.",
                                   "Cycles spent on rays that hit nothing, in red; hits are grey.",
                                   "Which core traced the ray.",
                                   "Which voxel was hit, each in a colour of its own."};
  for (std::size_t i = 0; i < 9; ++i) {
    CAPTURE(sentences[i]);
    const std::size_t left = s.left(i);
    CHECK(s.tells(left, s.top_of(i, 10) - 10, sentences[i], "DejaVuSans", 14, soft_ink, algo::TextAlignX::Left, left, left + panel_width));
  }
}

TEST_CASE("contact sheet: large frames are made smaller, of the cores' map its middle is shown") {
  const unsigned width = 960, height = 320;
  const sheet_of s(mixed_frame(width, height));
  // The first row's height is known; the last is found by the map of cores, which is enlarged and not averaged.
  const auto cores_at = [&](std::size_t top) {
    for (std::size_t y = 0; y < 160; y += 3)
      for (std::size_t x = 0; x < panel_width; x += 3)
        if (s.sheet.at(s.left(7) + x, top + y) != s.maps[7].at((width - 120) / 2 + x / 4, (height - 40) / 2 + y / 4)) return false;
    return true;
  };
  std::vector<std::size_t> tops;
  for (std::size_t y = 0; y + 160 < s.sheet.height; ++y)
    if (cores_at(y)) tops.push_back(y);
  REQUIRE(tops.size() == 1);
  // Of the model's map each pixel is one of the four that it stands for.
  std::size_t strange = 0;
  for (std::size_t y = 0; y < 160; ++y)
    for (std::size_t x = 0; x < panel_width; ++x) {
      const rgb& shown = s.sheet.at(s.left(8) + x, tops[0] + y);
      bool found = false;
      for (std::size_t k = 0; k < 4; ++k) found |= s.maps[8].at(2 * x + k % 2, 2 * y + k / 2) == shown;
      strange += !found;
    }
  CHECK(strange == 0);
  // Others are means: about that of their four, and of the whole the same.
  for (const std::size_t panel : {std::size_t{1}, std::size_t{2}}) {
    CAPTURE(panel);
    std::array<double, 3> whole{}, small{};
    for (const rgb& p : s.maps[panel].pixels)
      for (std::size_t i = 0; i < 3; ++i) whole[i] += p[i] / (960.0 * 320);
    std::size_t grey = 0;
    for (std::size_t y = 0; y < 160; ++y)
      for (std::size_t x = 0; x < panel_width; ++x)
        for (std::size_t i = 0; i < 3; ++i) {
          small[i] += s.sheet.at(s.left(panel) + x, first_panel + y)[i] / (480.0 * 160);
          grey += std::abs(s.sheet.at(s.left(panel) + x, first_panel + y)[i] - 127) < 60;
        }
    for (std::size_t i = 0; i < 3; ++i) CHECK(small[i] == Approx(whole[i]).margin(1.5));
    CHECK(grey > 480 * 160);  // of 3 * 480 * 160: sums of many
  }
}

TEST_CASE("contact sheet: a frame of another shape stands in its panel's middle") {
  const sheet_of s(mixed_frame(10, 30));  // 1440 high would be too much: 480, and 160 wide
  const rgb& corner = s.sheet.at(s.left(1) + 160, first_panel);
  CHECK(corner == s.maps[1].at(0, 0));
  CHECK(s.sheet.at(s.left(1) + 160 + 159, first_panel + 479) == s.maps[1].at(9, 29));
  for (const std::size_t x : {std::size_t{0}, std::size_t{159}, std::size_t{320}, std::size_t{479}})
    CHECK(s.sheet.at(s.left(1) + x, first_panel + 200) == background);
  const sheet_of flat(mixed_frame(48, 2));  // 20 high: held at 120
  CHECK(flat.sheet.at(flat.left(1), first_panel + 49) == background);
  CHECK(flat.sheet.at(flat.left(1), first_panel + 50) == flat.maps[1].at(0, 0));
  CHECK(flat.sheet.at(flat.left(1) + 479, first_panel + 69) == flat.maps[1].at(47, 1));
  CHECK(flat.sheet.at(flat.left(1), first_panel + 70) == background);
  CHECK(flat.sheet.at(flat.left(1) + 479, first_panel + 119) == background);
  CHECK(flat.sheet.at(flat.left(1), first_panel + 120) == rgb{255, 255, 255});
}

}  // namespace rtusim
