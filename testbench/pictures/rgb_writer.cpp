#include "testbench/pictures/rgb_writer.h"

#include "testbench/pictures/picture_file.h"

extern "C" void rtusim_write_rgb(const rtusim::picture_target& target, const rtusim::rgb_picture& picture) {
  rtusim::picture_file out(target, "png", rtusim::png_spec(picture.width, picture.height));
  out.rows(0, picture.height, OIIO::TypeDesc::UINT8, picture.samples.data());
  out.finish();
}
