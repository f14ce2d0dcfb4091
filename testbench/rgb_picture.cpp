#include "testbench/rgb_picture.h"

#include "testbench/picture_library.h"
#include "testbench/rgb_writer.h"

namespace rtusim {

void write_png(const std::filesystem::path& file, const rgb_picture& picture) {
  reinterpret_cast<decltype(&rtusim_write_rgb)>(picture_function("rtusim_write_rgb"))(file, picture);
}

}  // namespace rtusim
