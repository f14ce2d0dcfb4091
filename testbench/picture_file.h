#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "modules/config/files.h"
#include "testbench/frame.h"

namespace rtusim {

/// A picture being written: OpenImageIO writes beside the final place, and its complaints become input errors. It writes through
/// a handle of ours, as left to itself it takes no notice when the last bytes of a PNG find the disk full.
class picture_file {
 public:
  picture_file(const std::filesystem::path& file, const char* format, const OIIO::ImageSpec& spec);

  void rows(unsigned first, unsigned past, OIIO::TypeDesc type, const void* data) {
    check(writer_->write_scanlines(static_cast<int>(first), static_cast<int>(past), 0, type, data));
  }
  void commit();

 private:
  struct closer {
    void operator()(std::FILE* handle) const { std::fclose(handle); }
  };
  void check(bool good) const {
    if (!good) fail(writer_->geterror());
  }
  [[noreturn]] void fail(std::string why) const;

  // In this order: a writer that is given up still writes its end, and the file is removed last.
  std::string name_;
  config::output_file file_;
  std::unique_ptr<std::FILE, closer> handle_;
  std::optional<OIIO::Filesystem::IOFile> sink_;
  std::unique_ptr<OIIO::ImageOutput> writer_;
};

/// 8 bit sRGB. `description`: a text that the file keeps; none when empty.
OIIO::ImageSpec png_spec(unsigned width, unsigned height, const std::string& description = {});

/// Rows in bands, so that a large frame needs no second copy: `fill(pixel, to)` puts one pixel's channels; pixels count in raster order.
template <class Value, class Fill>
void write_bands(picture_file& out, const frame& picture, std::size_t channels, OIIO::TypeDesc type, const Fill& fill) {
  constexpr unsigned rows_a_write = 64;
  std::vector<Value> band(channels * picture.width() * rows_a_write);
  std::size_t pixel = 0;
  for (unsigned first = 0; first < picture.height(); first += rows_a_write) {
    const unsigned past = std::min(first + rows_a_write, picture.height());
    Value* to = band.data();
    for (const std::size_t end = std::size_t{past} * picture.width(); pixel < end; ++pixel, to += channels) fill(pixel, to);
    out.rows(first, past, type, band.data());
  }
  out.commit();
}

}  // namespace rtusim
