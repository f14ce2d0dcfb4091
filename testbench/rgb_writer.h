#pragma once

#include <filesystem>

#include "testbench/rgb_picture.h"

/// What the library `rtusim_pictures` offers for pictures that are not a frame's: `write_png` by OpenImageIO.
extern "C" void rtusim_write_rgb(const std::filesystem::path& file, const rtusim::rgb_picture& picture);
