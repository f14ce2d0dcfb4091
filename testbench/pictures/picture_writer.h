#pragma once

#include "testbench/pictures/frame.h"
#include "testbench/pictures/pictures.h"
#include "testbench/pictures/rgb_picture.h"

/// What the library `rtusim_pictures` offers: `write_picture` by OpenImageIO. OpenImageIO brings some 250 other libraries, whose
/// loading takes longer than many a run, so it stands apart and is loaded when a picture is asked for.
extern "C" void rtusim_write_picture(const rtusim::picture_target& target, const rtusim::frame& picture, rtusim::picture_kind kind,
                                     const rtusim::picture_text& text);
