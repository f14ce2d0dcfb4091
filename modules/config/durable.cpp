#include "modules/config/durable.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "modules/config/error.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, int error) {
  throw input_error(file.string(), std::generic_category().message(error), "to write it to the disk");
}

/// A file that is open while this lives.
class descriptor {
 public:
  descriptor(const fs::path& file, int flags) : number_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {
    if (number_ < 0) refuse(file, errno);
  }
  ~descriptor() { ::close(number_); }
  descriptor(const descriptor&) = delete;
  descriptor& operator=(const descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

void sync_folder(const std::filesystem::path& folder) {
  const descriptor open(folder, O_RDONLY | O_DIRECTORY);
  // Some file systems have folders that can't be synced, and need not be.
  if (::fsync(open.number()) != 0 && errno != EINVAL) refuse(folder, errno);
}

void sync_file_system(const std::filesystem::path& place) {
  const descriptor open(place, O_RDONLY);
  if (::syncfs(open.number()) != 0) refuse(place, errno);
}

void write_new_file(const std::filesystem::path& file, std::string_view bytes) {
  const descriptor open(file, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW);
  while (!bytes.empty()) {
    const ssize_t written = ::write(open.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      ::unlink(file.c_str());
      refuse(file, error);
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace rtusim::config
