#include "testbench/pictures/rgb_picture.h"

#include "modules/config/files.h"
#include "testbench/pictures/picture_library.h"
#include "testbench/pictures/rgb_writer.h"

namespace rtusim {

void write_png(const std::filesystem::path& file, const rgb_picture& picture) {
  const auto write = reinterpret_cast<decltype(&rtusim_write_rgb)>(picture_function("rtusim_write_rgb"));
  config::output_file out(file);
  write({file.string(), out.descriptor()}, picture);
  out.commit();
}

}  // namespace rtusim
