#pragma once

#include "testbench/pictures/frame.h"
#include "testbench/pictures/pictures.h"
#include "testbench/pictures/rgb_picture.h"

namespace rtusim {

/// Writes nine maps of a frame side by side, each with a title, a sentence, and a legend.
/// Errors: input_error when the file can't be written or the font is missing.
void write_sheet(const picture_target& target, const frame& picture, const picture_text& text);

}  // namespace rtusim
