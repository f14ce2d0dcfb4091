#include "modules/config/files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>
#define ZLIB_CONST  // next_in points to const
#include <zlib.h>

#include "modules/config/error.h"
#include "modules/config/input_ledger.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t chunk_bytes = std::size_t{1} << 18;

std::string reason(int error) { return std::generic_category().message(error); }

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
  RTU_CHECK(inflateInit2(&stream, gzip_alone), ==, Z_OK);
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
    } else if (status == Z_BUF_ERROR || (status == Z_OK && zipped.empty() && stream.avail_out != 0)) {
      throw broken("it is cut short");
    } else if (status != Z_OK) {
      throw broken(stream.msg ? stream.msg : zError(status));
    }
  }
}

/// Devices, pipes, and the names of open files: a rename would put a file in their place.
bool is_written_directly(const fs::path& file) {
  std::error_code ignored;
  const auto status = fs::status(file, ignored);
  const std::string name = fs::absolute(file, ignored).lexically_normal().string();
  const bool names_open_file = name.rfind("/dev/", 0) == 0 || name.rfind("/proc/", 0) == 0;
  return fs::exists(status) && (!fs::is_regular_file(status) || (names_open_file && fs::is_symlink(file, ignored)));
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes) {
  std::string bytes = input_ledger::read_through(file, [&] { return read_plain(file, most_bytes); });
  if (bytes.size() > most_bytes) throw too_large(file, most_bytes);  // kept by a reader that takes more
  return starts_gzip(bytes) ? unzip(bytes, file, most_bytes) : bytes;
}

void check_writable(const std::filesystem::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored) || !is_written_directly(file)) output_file{file};
}

output_file::output_file(std::filesystem::path file) : file_(std::move(file)), target_(file_), buffer_(std::size_t{1} << 20) {
  const auto refuse = [this](const std::string& found) { throw input_error(file_.string(), found, "to write it"); };
  std::error_code ignored;
  if (fs::is_directory(file_, ignored) || !file_.has_filename()) refuse("a folder");
  if (is_written_directly(file_)) {
    temporary_ = target_;
    handle_ = std::fopen(temporary_.c_str(), "wb");
  } else {
    if (std::error_code error; fs::is_symlink(file_, ignored)) {
      target_ = fs::weakly_canonical(file_, error);
      if (error) refuse(error.message());
    }
    if (fs::exists(target_, ignored) && ::access(target_.c_str(), W_OK) != 0) refuse(reason(errno));
    const std::string part = fmt::format(".{}.part-{}", target_.stem().string(), ::getpid());
    for (unsigned other = 0; !handle_ && (other == 0 || errno == EEXIST); ++other) {
      temporary_ = target_;
      temporary_.replace_filename((other == 0 ? part : fmt::format("{}-{}", part, other)) + target_.extension().string());
      handle_ = std::fopen(temporary_.c_str(), "wbx");
    }
  }
  if (!handle_) refuse(errno == ENOENT ? "its folder does not exist" : reason(errno));
  std::setvbuf(handle_, buffer_.data(), _IOFBF, buffer_.size());
}

output_file::~output_file() {
  if (handle_) std::fclose(handle_);
  std::error_code ignored;
  if (!committed_ && temporary_ != target_) fs::remove(temporary_, ignored);
}

void output_file::write(std::string_view bytes) {
  RTU_CHECK(handle_ != nullptr, ==, true);
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), handle_) != bytes.size())
    throw input_error(file_.string(), reason(errno), "to write it");
}

void output_file::release() { close(); }

void output_file::commit() {
  close();
  std::error_code error;
  if (temporary_ != target_) fs::rename(temporary_, target_, error);
  if (error) throw input_error(file_.string(), error.message(), "to write it");
  committed_ = true;
}

void output_file::close() {
  if (handle_ && std::fclose(std::exchange(handle_, nullptr)) != 0) throw input_error(file_.string(), reason(errno), "to write it");
}

}  // namespace rtusim::config
