#include "testbench/rgb_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "modules/config/error.h"
#include "modules/config/files.h"

extern "C" void rtusim_write_rgb(const std::filesystem::path& file, const rtusim::rgb_picture& picture) {
  using namespace rtusim;
  const auto fail = [&file](std::string why) {
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw input_error(file.string(), why, "a place where a picture can be written");
  };
  config::output_file out(file);
  out.release();
  // A handle of ours: left to itself, OpenImageIO takes no notice of a full disk.
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> handle(std::fopen(out.temporary().c_str(), "wb"), &std::fclose);
  if (!handle) fail(std::generic_category().message(errno));
  OIIO::Filesystem::IOFile sink(handle.get(), OIIO::Filesystem::IOProxy::Write);
  const auto png = OIIO::ImageOutput::create("png");
  if (!png) fail(OIIO::geterror());
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!png->set_ioproxy(&sink) || !png->open(file.string(), spec) || !png->write_image(OIIO::TypeDesc::UINT8, picture.samples.data()) ||
      !png->close())
    fail(png->geterror());
  const bool failed_before = std::ferror(handle.get()) != 0;
  if (std::fclose(handle.release()) != 0 || failed_before) fail("not all of it could be written");
  out.commit();
}
