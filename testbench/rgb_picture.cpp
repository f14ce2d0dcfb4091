#include "testbench/rgb_picture.h"

#include <dlfcn.h>

#include "modules/config/error.h"
#include "testbench/rgb_writer.h"

namespace rtusim {

void write_png(const std::filesystem::path& file, const rgb_picture& picture) {
  constexpr const char* library_name = "librtusim_pictures.so";
  const auto path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / library_name;
  void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  void* const writer = library != nullptr ? dlsym(library, "rtusim_write_rgb") : nullptr;
  if (writer == nullptr) throw input_error(library_name, dlerror(), "it beside the program, as the build leaves it");
  reinterpret_cast<decltype(&rtusim_write_rgb)>(writer)(file, picture);
}

}  // namespace rtusim
