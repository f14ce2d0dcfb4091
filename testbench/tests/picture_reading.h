#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <catch2/catch.hpp>

/// Pictures read back.
namespace rtusim::test {

using rgb = std::array<int, 3>;

/// What 8 bits make of a colour whose components go from 0 to 1: rounded down, as the thesis' driver does.
inline rgb bytes_of_colour(double red, double green, double blue) {
  const auto byte = [](double v) { return static_cast<int>(std::floor(v * 255)); };
  return {byte(red), byte(green), byte(blue)};
}

inline bool near(const rgb& a, const rgb& b, int most = 1) {
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(a[i] - b[i]) > most) return false;
  return true;
}

/// A PNG.
struct png {
  std::size_t width = 0, height = 0;
  std::vector<rgb> pixels;
  std::string description;

  explicit png(const std::filesystem::path& file) {
    const auto in = OIIO::ImageInput::open(file.string());
    REQUIRE(in);
    REQUIRE(in->spec().nchannels == 3);
    width = static_cast<std::size_t>(in->spec().width);
    height = static_cast<std::size_t>(in->spec().height);
    description = std::string(in->spec().get_string_attribute("ImageDescription"));
    std::vector<std::uint8_t> bytes(3 * width * height);
    REQUIRE(in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
    for (std::size_t i = 0; i < bytes.size(); i += 3) pixels.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
  }
  const rgb& at(std::size_t x, std::size_t y) const { return pixels.at(y * width + x); }
};

/// The channels of an EXR by name, in raster order.
using layers = std::map<std::string, std::vector<float>>;

inline layers read_layers(const std::filesystem::path& file) {
  const auto in = OIIO::ImageInput::open(file.string());
  REQUIRE(in);
  const auto& names = in->spec().channelnames;
  std::vector<float> values(in->spec().image_pixels() * names.size());
  REQUIRE(in->read_image(0, 0, 0, static_cast<int>(names.size()), OIIO::TypeDesc::FLOAT, values.data()));
  layers channels;
  for (std::size_t i = 0; i < values.size(); ++i) channels[names[i % names.size()]].push_back(values[i]);
  return channels;
}

}  // namespace rtusim::test
