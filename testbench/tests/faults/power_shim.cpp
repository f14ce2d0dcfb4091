// Stands between a program and the C library, by LD_PRELOAD, and keeps what is on the disk for certain: of each file what it held when it
// was synced last, of each folder its names then.
//
// POWER_ROOT is the folder that is watched, POWER_JOURNAL where the rest goes: `log` has a line for each call that synced something, and
// the Nth call leaves `N.INODE.file`, its bytes, and `N.INODE.folder`, a line `INODE NAME` for each entry, with `/` after a folder's name,
// of all that it synced. Calls of several processes come one after the other.

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// The calls in progress, one at a time over all processes.
class journal {
 public:
  journal() : folder_(std::getenv("POWER_JOURNAL")), root_(std::getenv("POWER_ROOT")) {
    log_ = ::open((folder_ + "/log").c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    ::flock(log_, LOCK_EX);
    struct stat s {};
    ::fstat(log_, &s);
    number_ = s.st_size / line_bytes;
  }
  ~journal() {
    if (kept_ && ::write(log_, "a call.\n", line_bytes) != line_bytes) std::abort();
    ::close(log_);
  }
  journal(const journal&) = delete;
  journal& operator=(const journal&) = delete;

  void keep_descriptor(int descriptor) {
    char path[PATH_MAX];
    const ssize_t n = ::readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path, sizeof path);
    const std::string name(path, n < 0 ? 0 : static_cast<std::size_t>(n));
    if (name == root_ || name.rfind(root_ + '/', 0) == 0) keep(name);
  }
  void keep_all() { keep_below(root_); }

 private:
  static constexpr long line_bytes = 8;

  void keep(const std::string& path) {
    struct stat s {};
    if (::lstat(path.c_str(), &s) != 0) return;
    kept_ = true;
    std::FILE* const to = std::fopen(
        (folder_ + '/' + std::to_string(number_) + '.' + std::to_string(s.st_ino) + (S_ISDIR(s.st_mode) ? ".folder" : ".file")).c_str(),
        "wb");
    if (S_ISDIR(s.st_mode)) {
      DIR* const folder = ::opendir(path.c_str());
      while (const dirent* e = folder == nullptr ? nullptr : ::readdir(folder)) {
        const std::string name = e->d_name;
        if (name == "." || name == "..") continue;
        std::fprintf(to, "%lu %s%s\n", static_cast<unsigned long>(e->d_ino), e->d_name, e->d_type == DT_DIR ? "/" : "");
      }
      if (folder != nullptr) ::closedir(folder);
    } else if (std::FILE* const from = std::fopen(path.c_str(), "rb")) {
      char bytes[1 << 16];
      for (std::size_t n; (n = std::fread(bytes, 1, sizeof bytes, from)) > 0;) std::fwrite(bytes, 1, n, to);
      std::fclose(from);
    }
    std::fclose(to);
  }
  void keep_below(const std::string& path) {
    keep(path);
    DIR* const folder = ::opendir(path.c_str());
    if (folder == nullptr) return;
    while (const dirent* e = ::readdir(folder)) {
      const std::string name = e->d_name;
      if (name == "." || name == "..") continue;
      if (e->d_type == DT_DIR)
        keep_below(path + '/' + name);
      else
        keep(path + '/' + name);
    }
    ::closedir(folder);
  }

  std::string folder_, root_;
  int log_ = -1;
  long number_ = 0;
  bool kept_ = false;
};

}  // namespace

// NOLINTBEGIN(readability-identifier-naming)
extern "C" {

int fsync(int descriptor) {
  const int result = next<int (*)(int)>("fsync")(descriptor);
  if (result == 0) journal().keep_descriptor(descriptor);
  return result;
}
int fdatasync(int descriptor) {
  const int result = next<int (*)(int)>("fdatasync")(descriptor);
  if (result == 0) journal().keep_descriptor(descriptor);
  return result;
}
int syncfs(int descriptor) {
  const int result = next<int (*)(int)>("syncfs")(descriptor);
  if (result == 0) journal().keep_all();
  return result;
}
}
// NOLINTEND(readability-identifier-naming)
