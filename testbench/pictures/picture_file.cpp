#include "testbench/pictures/picture_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <system_error>

#include "modules/config/error.h"

namespace rtusim {

std::size_t picture_sink::write(const void* bytes, std::size_t count) {
  std::size_t done = 0;
  while (done < count && failure_ == 0) {
    const ssize_t n = ::write(descriptor_, static_cast<const char*>(bytes) + done, count - done);
    if (n >= 0)
      done += static_cast<std::size_t>(n);
    else if (errno != EINTR)
      failure_ = errno;
  }
  m_pos += static_cast<std::int64_t>(done);
  return done;
}

bool picture_sink::seek(std::int64_t offset) {
  if (offset == m_pos) return true;
  const int flags = ::fcntl(descriptor_, F_GETFL);
  if (flags >= 0 && (flags & O_APPEND) != 0) errno = ESPIPE;  // every write would go to the end
  if ((flags & O_APPEND) != 0 || ::lseek(descriptor_, offset - m_pos, SEEK_CUR) < 0) {
    if (failure_ == 0) failure_ = errno;
    return false;
  }
  m_pos = offset;
  return true;
}

picture_file::picture_file(const picture_target& target, const char* format, const OIIO::ImageSpec& spec)
    : name_(target.name), sink_(target), writer_(OIIO::ImageOutput::create(format)) {
  if (!writer_) fail(OIIO::geterror());
  check(writer_->set_ioproxy(&sink_));
  check(writer_->open(name_, spec));
}

void picture_file::finish() {
  check(writer_->close());
  if (sink_.failure() != 0) fail({});
}

void picture_file::fail(std::string why) const {
  if (sink_.failure() != 0) why = std::generic_category().message(sink_.failure());
  // As the libraries call it, none of which says it by its type.
  for (const char* word : {"bad_alloc", "PNG write structure", "PNG info structure", "allocate"})
    if (why.find(word) != std::string::npos) throw std::bad_alloc();
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
