#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace rtusim {

/// Pixels of red, green and blue, 8 bits each, sRGB, in raster order from the top.
struct rgb_picture {
  unsigned width = 0;
  unsigned height = 0;
  std::vector<std::uint8_t> samples;  ///< 3 * width * height
};

/// Writes a PNG through OpenImageIO, which is loaded for it. The file appears under its name only when whole.
/// Errors: input_error when the file can't be written.
void write_png(const std::filesystem::path& file, const rgb_picture& picture);

}  // namespace rtusim
