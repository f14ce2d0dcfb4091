#include "testbench/pictures/picture_writer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "testbench/pictures/ambient_shade.h"
#include "testbench/pictures/contact_sheet.h"
#include "testbench/pictures/picture_file.h"
#include "testbench/pictures/picture_maps.h"

namespace rtusim {
namespace {

void write_png(const picture_target& target, const frame& picture, picture_kind kind) {
  const picture_map map = map_of(picture, kind);
  picture_file out(target, "png", png_spec(picture.width(), picture.height(), scale_text(map)));
  write_bands<std::uint8_t>(out, picture, 3, OIIO::TypeDesc::UINT8, [&](std::size_t pixel, std::uint8_t* to) {
    for (const double value : map.at(pixel)) *to++ = static_cast<std::uint8_t>(value * 255);
  });
}

/// A layer of the EXR.
struct layer {
  std::vector<std::string> channels;
  std::function<void(std::size_t pixel, float* to)> put;
};

layer one(const char* name, std::function<float(std::size_t)> value) {
  return {{name}, [value = std::move(value)](std::size_t i, float* to) { *to = value(i); }};
}

/// `value` gives three numbers.
template <class Value>
layer three(std::vector<std::string> names, Value value) {
  return {std::move(names), [value](std::size_t i, float* to) {
            for (const auto v : value(i)) *to++ = static_cast<float>(v);
          }};
}

std::vector<layer> layers_of(const frame& f) {
  const auto& pixels = f.pixels();
  const auto& points = f.where().points;
  const auto shade = std::make_shared<surface_shade>(shade_of(f));
  const auto light = [](const picture_map& map) {
    return [at = map.at](std::size_t i) {
      colour c = at(i);
      for (double& value : c) value = linear_light(value);
      return c;
    };
  };
  std::vector<layer> all{
      three({"R", "G", "B"}, light(map_of(f, picture_kind::shaded))),
      one("hit", [&](std::size_t i) { return pixels[i].hit ? 1.0f : 0.0f; }),
      one("depth", [&](std::size_t i) { return pixels[i].t_hit; }),
      three({"normal.x", "normal.y", "normal.z"}, [&](std::size_t i) { return normal_of(f, i); }),
      one("cost", [&](std::size_t i) { return static_cast<float>(pixels[i].cost); }),
      one("core", [&](std::size_t i) { return pixels[i].arrived ? static_cast<float>(pixels[i].core) : -1.0f; }),
      one("latency", [&](std::size_t i) { return static_cast<float>(pixels[i].latency_cycles); }),
      one("wait", [&](std::size_t i) { return static_cast<float>(f.wait_cycles(pixels[i])); }),
      three({"lit.R", "lit.G", "lit.B"}, light(lit_map(f, shade))),
      one("ambient", [shade](std::size_t i) { return shade->open[i]; }),
      three({"position.x", "position.y", "position.z"}, [&](std::size_t i) { return points.empty() ? std::array<float, 3>{} : points[i]; }),
      one("model", [&](std::size_t i) { return pixels[i].hit ? 0.0f : -1.0f; })};
  if (!f.surfaces().empty())
    all.push_back(one("triangle", [&](std::size_t i) { return pixels[i].hit ? static_cast<float>(f.surfaces()[i].triangle) : -1.0f; }));
  else
    all.push_back(three({"voxel.x", "voxel.y", "voxel.z"}, [&](std::size_t i) {
      std::array<float, 3> numbers{-1, -1, -1};
      if (const auto voxel = voxel_of(f, i))
        for (std::size_t axis = 0; axis < 3; ++axis) numbers[axis] = static_cast<float>((*voxel)[axis]);
      return numbers;
    }));
  return all;
}

void write_exr(const picture_target& target, const frame& picture) {
  const std::vector<layer> layers = layers_of(picture);
  std::vector<std::string> names;
  for (const layer& l : layers) names.insert(names.end(), l.channels.begin(), l.channels.end());
  OIIO::ImageSpec spec(static_cast<int>(picture.width()), static_cast<int>(picture.height()), static_cast<int>(names.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // left to itself, OpenImageIO puts the time of writing into the bytes
  picture_file out(target, "openexr", spec);
  write_bands<float>(out, picture, names.size(), OIIO::TypeDesc::FLOAT, [&](std::size_t pixel, float* to) {
    for (const layer& l : layers) {
      l.put(pixel, to);
      to += l.channels.size();
    }
  });
}

}  // namespace

}  // namespace rtusim

extern "C" void rtusim_write_picture(const rtusim::picture_target& target, const rtusim::frame& picture, rtusim::picture_kind kind,
                                     const rtusim::picture_text& text) {
  using namespace rtusim;
  switch (kind) {
    case picture_kind::layers: return write_exr(target, picture);
    case picture_kind::sheet: return write_sheet(target, picture, text);
    case picture_kind::shaded:
    case picture_kind::lit:
    case picture_kind::depth:
    case picture_kind::normal:
    case picture_kind::cost:
    case picture_kind::heat:
    case picture_kind::latency:
    case picture_kind::wait:
    case picture_kind::core:
    case picture_kind::model: return write_png(target, picture, kind);
  }
}
