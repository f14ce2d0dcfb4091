#include "testbench/picture_file.h"

#include <cerrno>
#include <system_error>

#include "modules/config/error.h"

namespace rtusim {

picture_file::picture_file(const std::filesystem::path& file, const char* format, const OIIO::ImageSpec& spec)
    : name_(file.string()), file_(file), writer_(OIIO::ImageOutput::create(format)) {
  if (!writer_) fail(OIIO::geterror());
  file_.release();
  handle_.reset(std::fopen(file_.temporary().c_str(), "wb"));
  if (!handle_) fail(std::generic_category().message(errno));
  sink_.emplace(handle_.get(), OIIO::Filesystem::IOProxy::Write);
  check(writer_->set_ioproxy(&*sink_));
  check(writer_->open(name_, spec));
}

void picture_file::commit() {
  check(writer_->close());
  const bool failed_before = std::ferror(handle_.get()) != 0;
  if (std::fclose(handle_.release()) != 0 || failed_before) fail("not all of it could be written");
  file_.commit();
}

void picture_file::fail(std::string why) const {
  std::replace(why.begin(), why.end(), '\n', ' ');
  throw input_error(name_, why, "a place where a picture can be written");
}

OIIO::ImageSpec png_spec(unsigned width, unsigned height, const std::string& description) {
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (!description.empty()) spec.attribute("ImageDescription", description);
  return spec;
}

}  // namespace rtusim
