#include "modules/config/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#define ZLIB_CONST  // next_in points to const
#include <zlib.h>

#include "modules/config/error.h"
#include "modules/config/input_ledger.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

/// What an error of the system's is called; for a lack of memory there is one name only.
std::string reason(int error) {
  if (error == ENOMEM) throw std::bad_alloc();
  return std::generic_category().message(error);
}

input_error too_large(const fs::path& file, std::uint64_t most_bytes) {
  return {file.string(), fmt::format("more than {} bytes", most_bytes), "a smaller file"};
}

std::string read_plain(const fs::path& file, std::uint64_t most_bytes) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw input_error(file.string(), "a folder", "a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> handle(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!handle) throw input_error(file.string(), errno == ENOENT ? "no such file" : reason(errno), "a file that can be read");
  const std::uintmax_t size = fs::is_regular_file(file, ignored) ? fs::file_size(file, ignored) : 0;
  std::string bytes;
  if (!ignored && size > most_bytes) throw too_large(file, most_bytes);
  if (!ignored) bytes.reserve(size);
  std::vector<char> chunk(chunk_bytes);
  while (const std::size_t n = std::fread(chunk.data(), 1, chunk.size(), handle.get())) {
    if (n > most_bytes - bytes.size()) throw too_large(file, most_bytes);
    bytes.append(chunk.data(), n);
  }
  if (std::ferror(handle.get())) throw input_error(file.string(), reason(errno), "a file that can be read");
  return bytes;
}

/// A member's magic number and its one compression method (RFC 1952, sec. 2.3.1).
bool starts_gzip(std::string_view bytes) { return bytes.substr(0, 3) == "\x1f\x8b\x08"; }

/// The contents of all members; zero padding after the last is taken, as gzip does (tapes).
std::string unzip(std::string_view zipped, const fs::path& file, std::uint64_t most_bytes) {
  constexpr int gzip_alone = 16 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, gzip_alone) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_streamp)> end(&stream, &inflateEnd);
  const auto broken = [&](std::string_view how) {
    return input_error(file.string(), fmt::format("broken gzip data ({})", how), "a whole gzip file");
  };
  std::string bytes;
  std::vector<unsigned char> chunk(chunk_bytes);
  while (true) {
    const auto offered = static_cast<uInt>(std::min<std::size_t>(zipped.size(), std::numeric_limits<uInt>::max()));
    stream.next_in = reinterpret_cast<const Bytef*>(zipped.data());
    stream.avail_in = offered;
    stream.next_out = chunk.data();
    stream.avail_out = static_cast<uInt>(chunk.size());
    const int status = inflate(&stream, Z_NO_FLUSH);
    const std::size_t n = chunk.size() - stream.avail_out;
    zipped.remove_prefix(offered - stream.avail_in);
    if (n > most_bytes - bytes.size()) throw too_large(file, most_bytes);
    bytes.append(reinterpret_cast<const char*>(chunk.data()), n);
    if (status == Z_STREAM_END) {
      if (zipped.find_first_not_of('\0') == std::string_view::npos) return bytes;
      if (!starts_gzip(zipped)) throw broken("no gzip member after the first");
      inflateReset(&stream);
    } else if (status == Z_MEM_ERROR) {
      throw std::bad_alloc();
    } else if (status == Z_BUF_ERROR || (status == Z_OK && zipped.empty() && stream.avail_out != 0)) {
      throw broken("it is cut short");
    } else if (status != Z_OK) {
      throw broken(stream.msg ? stream.msg : zError(status));
    }
  }
}

constexpr unsigned most_links = 40;  // as Linux follows

/// What a path names once its last part, while it is a link, is followed; the file itself need not be there.
fs::path behind_links(fs::path file, std::error_code& error) {
  std::error_code no_link;
  for (unsigned i = 0; i < most_links; ++i) {
    const fs::path next = fs::read_symlink(file, no_link);
    if (no_link) return file;
    file = file.parent_path() / next;
  }
  error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
  return file;
}

bool is_standard_output(const std::optional<int>& descriptor) { return descriptor == STDOUT_FILENO; }

/// Waits until what is open lies on the disk, where there is one. False, and `errno`: it does not.
bool sync(int descriptor) {
  while (::fsync(descriptor) != 0) {
    if (errno == EINVAL || errno == ENOTSUP) return true;
    if (errno != EINTR) return false;
  }
  return true;
}

/// What tells whether two outputs, or an output and an input, are one file.
std::vector<std::string> identities_of(const fs::path& file, const std::optional<int>& descriptor) {
  std::vector<std::string> all;
  if (descriptor) all.push_back(fmt::format("descriptor {}", *descriptor));
  struct stat found {};
  const int missing = descriptor ? ::fstat(*descriptor, &found) : ::stat(file.c_str(), &found);
  std::error_code ignored;
  if (missing == 0 && S_ISREG(found.st_mode))
    all.push_back(fmt::format("file {} {}", found.st_dev, found.st_ino));
  else if (missing != 0 && !descriptor)
    all.push_back("name " + fs::weakly_canonical(fs::absolute(behind_links(file, ignored), ignored), ignored).string());
  return all;
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes) {
  std::string bytes = input_ledger::read_through(file, [&] { return read_plain(file, most_bytes); });
  if (bytes.size() > most_bytes) throw too_large(file, most_bytes);  // kept by a reader that takes more
  return starts_gzip(bytes) ? unzip(bytes, file, most_bytes) : bytes;
}

std::optional<int> descriptor_named(const fs::path& file) {
  if (file == "-") return STDOUT_FILENO;
  std::error_code error;
  const fs::path open_files = fmt::format("/proc/{}/fd", ::getpid());
  fs::path at = fs::absolute(file, error);
  for (unsigned i = 0; i < most_links && !error; ++i) {
    const std::string name = at.filename().string();
    const fs::path folder = fs::canonical(at.parent_path(), error);
    int number = 0;
    if (const auto [end, bad] = std::from_chars(name.data(), name.data() + name.size(), number);
        !error && folder == open_files && bad == std::errc{} && end == name.data() + name.size() && number >= 0)
      return number;
    const fs::path next = fs::read_symlink(at, error);
    if (!error) at = at.parent_path() / next;
  }
  return {};
}

std::FILE* stream_beside(const std::vector<fs::path>& outputs) {
  const auto takes_it = [](const fs::path& file) { return !file.empty() && is_standard_output(descriptor_named(file)); };
  return std::any_of(outputs.begin(), outputs.end(), takes_it) ? stderr : stdout;
}

void check_writable(const fs::path& file) {
  struct stat found {};
  const bool is_direct =
      descriptor_named(file) || (::stat(file.c_str(), &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode));
  if (!is_direct) output_file{file};
}

void check_apart(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  std::map<std::string, std::pair<const fs::path*, bool>> known;  // by identity; and whether it is an input
  for (const fs::path& file : inputs)
    if (!file.empty())
      for (std::string& identity : identities_of(file, {})) known.emplace(std::move(identity), std::pair(&file, true));
  for (const fs::path& file : outputs) {
    if (file.empty()) continue;
    const auto descriptor = descriptor_named(file);
    const std::vector<std::string> identities = identities_of(file, descriptor);
    for (const std::string& identity : identities) {
      const auto found = known.find(identity);
      if (found == known.end()) continue;
      const auto& [other, is_input] = found->second;
      if (is_input) throw input_error(file.string(), fmt::format("the file of the input {}", other->string()), "a file of its own");
      throw input_error(file.string(), fmt::format("the file of the output {}, too", other->string()),
                        is_standard_output(descriptor) ? "at most one output there" : "a file of its own");
    }
    for (const std::string& identity : identities) known.emplace(identity, std::pair(&file, false));
  }
}

void check_writable_apart(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  check_apart(outputs, inputs);
  for (const fs::path& file : outputs)
    if (!file.empty()) check_writable(file);
}

std::atomic<unsigned> deferred_sync::living_{0};

deferred_sync::deferred_sync() { ++living_; }

deferred_sync::~deferred_sync() { --living_; }

output_file::output_file(fs::path file) : file_(std::move(file)), target_(file_) {
  buffer_.reserve(buffer_bytes);
  const auto refuse = [this](const std::string& found) { throw input_error(file_.string(), found, "to write it"); };
  std::error_code error;
  if (const auto named = descriptor_named(file_)) {
    standard_output_ = is_standard_output(named);
    descriptor_ = ::fcntl(*named, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (descriptor_ < 0) refuse(reason(errno));
  } else if (fs::is_directory(file_, error) || !file_.has_filename()) {
    refuse("a folder");
  } else {
    target_ = behind_links(file_, error = {});
    if (error) refuse(error.message());
    open_part();
  }
}

void output_file::open_part() {
  const auto refuse = [this](const std::string& found) { throw input_error(file_.string(), found, "to write it"); };
  struct stat before {};
  const bool is_there = ::stat(target_.c_str(), &before) == 0;
  if (!is_there && errno != ENOENT) refuse(reason(errno));
  if (is_there && !S_ISREG(before.st_mode)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) refuse(reason(errno));
    return;
  }
  if (is_there && ::access(target_.c_str(), W_OK) != 0) refuse(reason(errno));
  remove_leftovers(target_.parent_path());
  const mode_t mode = is_there ? before.st_mode & 0777 : 0666;
  for (unsigned number = 0; descriptor_ < 0 && (number == 0 || errno == EEXIST); ++number) {
    part_.reset();
    part_.emplace(target_, number);
    descriptor_ = ::open(part_->path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor_ < 0) {
      const int failed = errno;
      part_->keep();  // that of another output, if any
      errno = failed;
    }
  }
  if (descriptor_ < 0) refuse(errno == ENOENT ? "its folder does not exist" : reason(errno));
  if (!is_there) return;
  if (before.st_uid != ::geteuid() || before.st_gid != ::getegid()) {
    const bool is_given = ::fchown(descriptor_, before.st_uid, before.st_gid) == 0;
    if (!is_given && errno == ENOMEM) throw std::bad_alloc();
  }
  if (::fchmod(descriptor_, mode) != 0) refuse(reason(errno));
}

output_file::~output_file() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void output_file::write(std::string_view bytes) {
  RTU_CHECK(descriptor_, >=, 0);
  while (!bytes.empty()) {
    if (buffer_.size() == buffer_bytes) flush();
    const std::size_t n = std::min(bytes.size(), buffer_bytes - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
    bytes.remove_prefix(n);
  }
}

int output_file::descriptor() {
  flush();
  return descriptor_;
}

void output_file::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t n = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    done += static_cast<std::size_t>(n);
  }
  buffer_.clear();
}

void output_file::commit() {
  flush();
  const bool syncs = part_ && deferred_sync::living_ == 0;
  if (syncs && !sync(descriptor_)) fail(errno);
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(errno);
  if (!part_) return;
  if (::rename(part_->path().c_str(), target_.c_str()) != 0) fail(errno);
  part_->keep();
  if (!syncs) return;
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 && errno == EACCES) return;  // one may write into a folder that one may not read
  if (descriptor_ < 0 || !sync(descriptor_)) fail(errno);
}

void output_file::fail(int error) const {
  if (error == EPIPE && standard_output_) throw std::system_error(error, std::generic_category(), "standard output");
  throw input_error(file_.string(), reason(error), "to write it");
}

}  // namespace rtusim::config
