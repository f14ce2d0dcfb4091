#include "testbench/picture_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"

namespace rtusim {
namespace {

using colour = std::array<double, 3>;  // sRGB, 0 to 1

constexpr colour nothing_arrived{0, 0, 0};
constexpr colour miss_of_depth{0.08, 0.12, 0.30};
constexpr double nearest_grey = 0.95, farthest_grey = 0.15;
constexpr unsigned rows_a_write = 64;

colour grey(double value) { return {value, value, value}; }

double linear_light(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

/// A triangle's by the light that falls on it from above the eye's left; the eye is where its normal points.
colour shaded_hit(const frame& f, const frame::pixel& p) {
  if (f.surfaces().empty()) return grey(p.normal_axis == 0 ? 0.7 : p.normal_axis == 1 ? 0.9 : 0.5);
  const auto& n = f.surfaces()[static_cast<std::size_t>(&p - f.pixels().data())].normal;
  const double lit = (0.4 * n[0] + 0.8 * n[1] + 0.45 * n[2] + 1) / 2;
  return grey(0.2 + 0.75 * std::clamp(lit, 0.0, 1.0));
}

colour shaded(const frame& f, const frame::pixel& p) {
  if (!p.arrived) return nothing_arrived;
  return p.hit ? shaded_hit(f, p) : grey(1);
}

colour cost_shown(const frame& f, const frame::pixel& p) {
  if (!p.arrived) return nothing_arrived;
  if (p.hit) return shaded_hit(f, p);
  const double rest = std::min(1.0, std::pow(0.95, (p.cost - 2.0) / 2.0));
  return {1, rest, rest};
}

/// The span of t_hit over a frame's hits.
struct depth_span {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  explicit depth_span(const frame& f) {
    for (const auto& p : f.pixels())
      if (p.hit) {
        least = std::min<double>(least, p.t_hit);
        most = std::max<double>(most, p.t_hit);
      }
  }
  colour shown(const frame::pixel& p) const {
    if (!p.arrived) return nothing_arrived;
    if (!p.hit) return miss_of_depth;
    const double far = most > least ? (p.t_hit - least) / (most - least) : 0;
    return grey(nearest_grey + far * (farthest_grey - nearest_grey));
  }
};

/// A picture being written: OpenImageIO writes beside the final place, and its complaints become input errors. It writes through
/// a handle of ours, as left to itself it takes no notice when the last bytes of a PNG find the disk full.
class picture_file {
 public:
  picture_file(const std::filesystem::path& file, const char* format, const OIIO::ImageSpec& spec)
      : name_(file.string()), file_(file), writer_(OIIO::ImageOutput::create(format)) {
    if (!writer_) fail(OIIO::geterror());
    file_.release();
    handle_.reset(std::fopen(file_.temporary().c_str(), "wb"));
    if (!handle_) fail(std::generic_category().message(errno));
    sink_.emplace(handle_.get(), OIIO::Filesystem::IOProxy::Write);
    check(writer_->set_ioproxy(&*sink_));
    check(writer_->open(name_, spec));
  }
  void rows(unsigned first, unsigned past, OIIO::TypeDesc type, const void* data) {
    check(writer_->write_scanlines(static_cast<int>(first), static_cast<int>(past), 0, type, data));
  }
  void commit() {
    check(writer_->close());
    const bool failed_before = std::ferror(handle_.get()) != 0;
    if (std::fclose(handle_.release()) != 0 || failed_before) fail("not all of it could be written");
    file_.commit();
  }

 private:
  struct closer {
    void operator()(std::FILE* handle) const { std::fclose(handle); }
  };
  void check(bool good) const {
    if (!good) fail(writer_->geterror());
  }
  [[noreturn]] void fail(std::string why) const {
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw input_error(name_, why, "a place where a picture can be written");
  }

  // In this order: a writer that is given up still writes its end, and the file is removed last.
  std::string name_;
  config::output_file file_;
  std::unique_ptr<std::FILE, closer> handle_;
  std::optional<OIIO::Filesystem::IOFile> sink_;
  std::unique_ptr<OIIO::ImageOutput> writer_;
};

/// Rows in bands, so that a large frame needs no second copy: `fill(pixel, to)` puts one pixel's channels.
template <class Value, class Fill>
void write_bands(picture_file& out, const frame& picture, std::size_t channels, OIIO::TypeDesc type, Fill fill) {
  std::vector<Value> band(channels * picture.width() * rows_a_write);
  for (unsigned first = 0; first < picture.height(); first += rows_a_write) {
    const unsigned past = std::min(first + rows_a_write, picture.height());
    Value* to = band.data();
    for (unsigned y = first; y < past; ++y)
      for (unsigned x = 0; x < picture.width(); ++x, to += channels) fill(picture.at(x, y), to);
    out.rows(first, past, type, band.data());
  }
  out.commit();
}

template <class Paint>
void write_png(const std::filesystem::path& file, const frame& picture, Paint paint) {
  OIIO::ImageSpec spec(static_cast<int>(picture.width()), static_cast<int>(picture.height()), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  picture_file out(file, "png", spec);
  write_bands<std::uint8_t>(out, picture, 3, OIIO::TypeDesc::UINT8, [&](const frame::pixel& p, std::uint8_t* to) {
    for (const double value : paint(p)) *to++ = static_cast<std::uint8_t>(value * 255);
  });
}

void write_exr(const std::filesystem::path& file, const frame& picture) {
  const std::vector<std::string> names{"R", "G", "B", "hit", "depth", "normal.x", "normal.y", "normal.z", "cost", "core", "latency"};
  OIIO::ImageSpec spec(static_cast<int>(picture.width()), static_cast<int>(picture.height()), static_cast<int>(names.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // left to itself, OpenImageIO puts the time of writing into the bytes
  picture_file out(file, "openexr", spec);
  write_bands<float>(out, picture, names.size(), OIIO::TypeDesc::FLOAT, [&](const frame::pixel& p, float* to) {
    for (const double value : shaded(picture, p)) *to++ = static_cast<float>(linear_light(value));
    *to++ = p.hit ? 1.0f : 0.0f;
    *to++ = p.t_hit;
    if (picture.surfaces().empty()) {
      for (std::int8_t axis = 0; axis < 3; ++axis) *to++ = p.normal_axis == axis ? static_cast<float>(p.normal_sign) : 0.0f;
    } else {
      for (const float n : picture.surfaces()[static_cast<std::size_t>(&p - picture.pixels().data())].normal) *to++ = n;
    }
    *to++ = static_cast<float>(p.cost);
    *to++ = p.arrived ? static_cast<float>(p.core) : -1.0f;
    *to++ = static_cast<float>(p.latency_cycles);
  });
}

}  // namespace

}  // namespace rtusim

extern "C" void rtusim_write_picture(const std::filesystem::path& file, const rtusim::frame& picture, rtusim::picture_kind kind) {
  using namespace rtusim;
  switch (kind) {
    case picture_kind::shaded: return write_png(file, picture, [&](const frame::pixel& p) { return shaded(picture, p); });
    case picture_kind::cost: return write_png(file, picture, [&](const frame::pixel& p) { return cost_shown(picture, p); });
    case picture_kind::depth: {
      const depth_span span(picture);
      return write_png(file, picture, [&](const frame::pixel& p) { return span.shown(p); });
    }
    case picture_kind::layers: return write_exr(file, picture);
  }
}
