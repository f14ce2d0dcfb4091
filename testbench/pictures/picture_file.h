#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "testbench/pictures/frame.h"
#include "testbench/pictures/rgb_picture.h"

namespace rtusim {

/// An open file for OpenImageIO, which left to itself takes no notice when the last bytes of a PNG find the disk full.
class picture_sink : public OIIO::Filesystem::IOProxy {
 public:
  explicit picture_sink(const picture_target& target) : IOProxy(target.name, Write), descriptor_(target.descriptor) {}
  const char* proxytype() const override { return "descriptor"; }
  std::size_t write(const void* bytes, std::size_t count) override;
  bool seek(std::int64_t offset) override;
  /// The error of the first write that failed, as `errno` has it; 0: none did.
  int failure() const { return failure_; }

 private:
  int descriptor_;
  int failure_ = 0;
};

/// A picture that OpenImageIO writes into an open file; its complaints become input errors.
class picture_file {
 public:
  picture_file(const picture_target& target, const char* format, const OIIO::ImageSpec& spec);

  void rows(unsigned first, unsigned past, OIIO::TypeDesc type, const void* data) {
    check(writer_->write_scanlines(static_cast<int>(first), static_cast<int>(past), 0, type, data));
  }
  /// Writes the end.
  void finish();

 private:
  void check(bool good) const {
    if (!good) fail(writer_->geterror());
  }
  [[noreturn]] void fail(std::string why) const;

  // In this order: a writer that is given up still writes its end.
  std::string name_;
  picture_sink sink_;
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
  out.finish();
}

}  // namespace rtusim
