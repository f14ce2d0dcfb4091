#pragma once

#include "testbench/pictures/rgb_picture.h"

/// What the library `rtusim_pictures` offers for pictures that are not a frame's: `write_png` by OpenImageIO.
extern "C" void rtusim_write_rgb(const rtusim::picture_target& target, const rtusim::rgb_picture& picture);
