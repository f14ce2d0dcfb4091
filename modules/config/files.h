#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rtusim::config {

/// The bytes of a file; a `.gz` of one member or several is unzipped on the way (told by its first bytes, not its name).
/// `most_bytes` bounds what is read, before and after unzipping, so that nothing exhausts memory.
/// Errors: input_error when it is missing, a folder, unreadable, a broken or cut gzip, or larger than `most_bytes`.
std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes = std::uint64_t{1} << 31);

/// Sees that a file can be written, before there is something to write. Leaves no trace; a device or a pipe is not touched.
/// Errors: as `output_file`.
void check_writable(const std::filesystem::path& file);

/// A file being written: beside its place at first (`.STEM.part-PID.EXT`), renamed into it by `commit`, removed if that never
/// comes. Buffers generously; never leaves a file half-written. A link is followed; a device or a pipe (`/dev/stdout`) is
/// written directly, without a rename.
/// Errors: input_error when the folder is missing, can't be written, or the disk is full.
class output_file {
 public:
  explicit output_file(std::filesystem::path file);
  ~output_file();
  output_file(const output_file&) = delete;
  output_file& operator=(const output_file&) = delete;

  void write(std::string_view bytes);
  /// Flushes, closes and renames. Nothing may be written afterwards.
  void commit();
  /// The temporary path, for libraries that write by themselves (OpenImageIO, SystemC's tracer); it has the final extension.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// For such libraries: closes our handle so that they can open `temporary()`.
  void release();

 private:
  void close();
  std::filesystem::path file_;       // as the user named it
  std::filesystem::path target_;     // where it goes: `file_`, its links followed
  std::filesystem::path temporary_;  // where it is written: `target_` itself for a device or a pipe
  std::vector<char> buffer_;         // stdio's
  std::FILE* handle_ = nullptr;
  bool committed_ = false;
};

}  // namespace rtusim::config
