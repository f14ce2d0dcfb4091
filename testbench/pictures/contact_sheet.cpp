#include "testbench/pictures/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/pictures/picture_file.h"
#include "testbench/pictures/picture_maps.h"

namespace rtusim {
namespace {

namespace algo = OIIO::ImageBufAlgo;

constexpr picture_kind shown[] = {picture_kind::lit,  picture_kind::normal, picture_kind::depth, picture_kind::heat, picture_kind::latency,
                                  picture_kind::wait, picture_kind::cost,   picture_kind::core,  picture_kind::model};
constexpr int columns = 3;
constexpr int panel_width = 480;
constexpr int least_panel_height = 120, most_panel_height = 480;
constexpr int margin = 28, gap = 28;
constexpr int header_height = 92, above_panel = 50, below_panel = 10;
constexpr int most_legend_height = 120;
constexpr int bar_height = 12;
constexpr int enlarged = 4;

constexpr colour paper = of_bytes(255, 255, 255);
constexpr colour ink = of_bytes(28, 30, 34);
constexpr colour soft_ink = of_bytes(96, 100, 108);
// Where Debian has them; by their names alone OpenImageIO would search all fonts for each line.
constexpr const char* plain_font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr const char* bold_font = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";

std::array<float, 3> floats(const colour& c) { return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])}; }

/// A style of text.
struct face {
  const char* font;
  int size;
  colour shown;
};
constexpr face headline{bold_font, 26, ink}, subline{plain_font, 17, soft_ink}, title{bold_font, 18, ink};
constexpr face sentence{plain_font, 14, soft_ink}, label{plain_font, 14, ink}, figures{plain_font, 13, soft_ink};

class sheet {
 public:
  sheet(const frame& f, const picture_text& text) : frame_(f) {
    const double tall = static_cast<double>(panel_width) * f.height() / f.width();
    panel_height_ = std::clamp(static_cast<int>(std::lround(tall)), least_panel_height, most_panel_height);
    constexpr int panels = static_cast<int>(std::size(shown)), rows = (panels + columns - 1) / columns;
    width_ = 2 * margin + columns * panel_width + (columns - 1) * gap;
    canvas_.reset(
        OIIO::ImageSpec(width_, header_height + rows * (above_panel + panel_height_ + most_legend_height), 3, OIIO::TypeDesc::UINT8));
    algo::fill(canvas_, floats(paper), {}, 1);
    write(margin, 48, text.title.empty() ? "rtusim" : text.title, headline, width_ - 2 * margin);
    write(margin, 76, text.details, subline, width_ - 2 * margin);
    int y = header_height;
    for (int first = 0; first < panels; first += columns) {
      int end = y;
      for (int i = first; i < std::min(first + columns, panels); ++i)
        end = std::max(end, panel(margin + (i - first) * (panel_width + gap), y, shown[i]));
      y = end + gap;
    }
    height_ = y;
  }

  void save(const picture_target& target) const {
    picture_file out(target, "png", png_spec(static_cast<unsigned>(width_), static_cast<unsigned>(height_)));
    out.rows(0, static_cast<unsigned>(height_), OIIO::TypeDesc::UINT8, canvas_.localpixels());
    out.finish();
  }

 private:
  static int width_of(const std::string& text, const face& how) {
    const OIIO::ROI size = algo::text_size(text, how.size, how.font);
    return size.defined() ? size.xend : 0;
  }

  /// From `x` on, on the line `y`; cut where it would be wider than `room`.
  void write(int x, int y, std::string text, const face& how, int room, algo::TextAlignX align = algo::TextAlignX::Left) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }, '?');
    const auto cut = [](std::string& whole) {  // by a letter, which may be several bytes
      do whole.pop_back();
      while (!whole.empty() && (static_cast<unsigned char>(whole.back()) & 0xc0) == 0x80);
    };
    for (std::string whole = text; !whole.empty();) {
      const int wide = width_of(text, how);
      if (wide <= room) break;
      // Letters differ in width: not quite all that seem too many.
      const auto kept = whole.size() * static_cast<std::size_t>(room) / static_cast<std::size_t>(wide) + 4;
      do cut(whole);
      while (whole.size() > kept);
      text = whole + "...";
    }
    if (text.empty()) return;
    const auto pen = floats(how.shown);
    if (!algo::render_text(canvas_, x, y, text, how.size, how.font, pen, align, algo::TextAlignY::Baseline, 0, {}, 1))
      throw input_error(how.font, canvas_.geterror(), "this font, which Debian's package fonts-dejavu-core brings");
  }

  void box(int x, int y, int width, int height, const colour& c) {
    algo::render_box(canvas_, x, y, x + width - 1, y + height - 1, floats(c), true, {}, 1);
  }

  /// One map with all that belongs to it; where its end is.
  int panel(int x, int y, picture_kind kind) {
    picture_map map = map_of(frame_, kind);
    if (is_cut(map)) map.meaning += fmt::format(" The picture's middle, {} times enlarged.", enlarged);
    write(x, y + 20, map.title, title, panel_width);
    write(x, y + 40, map.meaning, sentence, panel_width);
    paste(x, y + above_panel, map);
    return explain(x, y + above_panel + panel_height_ + below_panel, map);
  }

  double ratio() const {
    return std::min(static_cast<double>(panel_width) / frame_.width(), static_cast<double>(panel_height_) / frame_.height());
  }
  bool is_cut(const picture_map& map) const { return map.look == picture_map::reduction::middle && ratio() < 1; }

  /// The map, as large as the panel takes it.
  void paste(int x, int y, const picture_map& map) {
    unsigned from_width = frame_.width(), from_height = frame_.height();
    if (is_cut(map)) {
      from_width = std::min(from_width, static_cast<unsigned>(panel_width / enlarged));
      from_height = std::min(from_height, static_cast<unsigned>(panel_height_ / enlarged));
    }
    const std::size_t first = std::size_t{(frame_.height() - from_height) / 2} * frame_.width() + (frame_.width() - from_width) / 2;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(std::size_t{3} * from_width * from_height);
    for (unsigned row = 0; row < from_height; ++row)
      for (unsigned column = 0; column < from_width; ++column)
        for (const double value : map.at(first + std::size_t{row} * frame_.width() + column))
          bytes.push_back(static_cast<std::uint8_t>(value * 255));
    const OIIO::ImageBuf whole(OIIO::ImageSpec(static_cast<int>(from_width), static_cast<int>(from_height), 3, OIIO::TypeDesc::UINT8),
                               bytes.data());
    const double scale = is_cut(map) ? enlarged : ratio();
    const int width = std::clamp(static_cast<int>(std::lround(scale * from_width)), 1, panel_width);
    const int height = std::clamp(static_cast<int>(std::lround(scale * from_height)), 1, panel_height_);
    OIIO::ImageBuf small(OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::UINT8));
    if (map.look == picture_map::reduction::means && scale < 1)
      algo::resize(small, whole, "triangle", 0.0f, {}, 1);
    else
      algo::resample(small, whole, false, {}, 1);
    box(x, y, panel_width, panel_height_, nothing_met);
    algo::paste(canvas_, x + (panel_width - width) / 2, y + (panel_height_ - height) / 2, 0, 0, small, {}, 1);
  }

  /// The legend; where its end is.
  int explain(int x, int y, const picture_map& map) {
    int line = y;
    if (map.scale) {
      draw(x, y, *map.scale);
      line += bar_height + 24;
    }
    int to_x = x;
    if (map.scale && !map.scale->figures.empty()) {
      write(x, line + 11, map.scale->figures, figures, panel_width);
      to_x += width_of(map.scale->figures, figures) + 18;
    }
    for (const map_swatch& s : map.swatches) {
      const int wide = 18 + width_of(s.meaning, figures);
      if (to_x != x && to_x + wide > x + panel_width) {
        to_x = x;
        line += 19;
      }
      box(to_x, line, 13, 13, soft_ink);
      box(to_x + 1, line + 1, 11, 11, s.shown);
      write(to_x + 18, line + 11, s.meaning, figures, panel_width);
      to_x += wide + 14;
    }
    return line + 15;
  }

  void draw(int x, int y, const map_scale& scale) {
    for (int i = 0; i < panel_width; ++i) box(x + i, y, 1, bar_height, scale.shown(i / (panel_width - 1.0)));
    const int base = y + bar_height + 15;
    write(x, base, number_text(scale.low), label, panel_width);
    if (scale.high > scale.low)
      write(x + panel_width / 2, base, number_text((scale.low + scale.high) / 2), label, panel_width, algo::TextAlignX::Center);
    write(x + panel_width, base, fmt::format("{} {}{}", number_text(scale.high), scale.unit, scale.cut ? " and more" : ""), label,
          panel_width, algo::TextAlignX::Right);
  }

  const frame& frame_;
  int panel_height_ = 0, width_ = 0, height_ = 0;
  OIIO::ImageBuf canvas_;
};

}  // namespace

void write_sheet(const picture_target& target, const frame& picture, const picture_text& text) { sheet(picture, text).save(target); }

}  // namespace rtusim
