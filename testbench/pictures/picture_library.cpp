#include "testbench/pictures/picture_library.h"

#include <dlfcn.h>

#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "modules/config/error.h"

namespace rtusim {
namespace {

constexpr const char* library_name = "librtusim_pictures.so";

void* opened() {
  // By its whole path: a sanitizer's dlopen does not know the program's search path.
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto beside = folder / library_name, installed = folder.parent_path() / "lib/rtusim" / library_name;
  std::error_code unknown;
  const auto path = std::filesystem::exists(installed, unknown) && !std::filesystem::exists(beside, unknown) ? installed : beside;
  return dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
}

}  // namespace

void* picture_function(const char* name) {
  void* const library = opened();
  void* const function = library != nullptr ? dlsym(library, name) : nullptr;
  if (function == nullptr) {
    const std::string why = dlerror();
    for (const char* word : {"memory", "failed to map", "cannot allocate", "cannot create", "cannot extend"})  // as the loader says it
      if (why.find(word) != std::string::npos) throw std::bad_alloc();
    throw input_error(library_name, why, "it beside the program, as the build leaves it, or in ../lib/rtusim, as installed");
  }
  return function;
}

void share_picture_library() noexcept {
  try {
    opened();
  } catch (const std::exception&) {
    return;
  }
}

}  // namespace rtusim
