#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rtusim {

/// Pixels of red, green and blue, 8 bits each, sRGB, in raster order from the top.
struct rgb_picture {
  unsigned width = 0;
  unsigned height = 0;
  std::vector<std::uint8_t> samples;  ///< 3 * width * height
};

/// An open file that a picture is written into, from where it stands.
struct picture_target {
  std::string name;  ///< for messages
  int descriptor = -1;
};

/// Writes a PNG through OpenImageIO, which is loaded for it. The file appears under its name only when whole.
/// Errors: input_error when the file can't be written.
void write_png(const std::filesystem::path& file, const rgb_picture& picture);

}  // namespace rtusim
