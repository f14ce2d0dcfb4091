#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "modules/config/temporary.h"

namespace rtusim::config {

/// The bytes of a file; a `.gz` of one member or several is unzipped on the way (told by its first bytes, not its name).
/// `most_bytes` bounds what is read, before and after unzipping, so that nothing exhausts memory.
/// Errors: input_error when it is missing, a folder, unreadable, a broken or cut gzip, or larger than `most_bytes`.
std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes = std::uint64_t{1} << 31);

/// An output that is an open file of this process: `-` (standard output), `/dev/stdout`, `/dev/fd/N`, `/proc/self/fd/N`, or a link to one.
std::optional<int> descriptor_named(const std::filesystem::path& file);

/// Where a summary goes: standard output, or standard error when one of these outputs goes to the former.
std::FILE* stream_beside(const std::vector<std::filesystem::path>& outputs);

/// Sees that a file can be written, before there is something to write. Leaves no trace; a device or a pipe is not touched.
/// Errors: as `output_file`.
void check_writable(const std::filesystem::path& file);

/// Sees that no output is the file of an input or of another output, whatever the names: links are followed, and hard links told. At most
/// one goes to standard output. Empty paths are passed over.
/// Errors: input_error that names both.
void check_apart(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs);

/// `check_apart`, and `check_writable` for each.
void check_writable_apart(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs);

/// While one lives, `output_file::commit` does not wait for the disk: its caller does, for many files at once.
class deferred_sync {
 public:
  deferred_sync();
  ~deferred_sync();
  deferred_sync(const deferred_sync&) = delete;
  deferred_sync& operator=(const deferred_sync&) = delete;

 private:
  friend class output_file;
  static std::atomic<unsigned> living_;
};

/// A file being written: beside its place at first (`temporary_file`), put into it by `commit`, removed if that never comes. Never leaves a
/// file half-written, and what is committed outlives a power cut. A link is followed, also one whose file is still to be made. A file that
/// was there keeps its mode, and its owner as far as that is allowed. A device or a pipe is written directly, an open file of this process
/// (`descriptor_named`) at the place where it stands. Of the part files that dead processes left in the folder nothing stays.
/// Errors: input_error when the folder is missing, can't be written, or the disk is full; std::system_error with EPIPE when standard output
/// is a pipe that nobody reads any more.
class output_file {
 public:
  explicit output_file(std::filesystem::path file);
  ~output_file();
  output_file(const output_file&) = delete;
  output_file& operator=(const output_file&) = delete;

  void write(std::string_view bytes);
  /// For libraries that write by themselves: the open file, what was written before in it. They write from where it stands.
  int descriptor();
  /// Writes the rest, waits for the disk and renames. Nothing may be written afterwards.
  void commit();

 private:
  void open_part();
  void flush();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;          // as the user named it
  std::filesystem::path target_;        // where it goes: `file_`, its links followed
  std::optional<temporary_file> part_;  // where it is written; none: directly
  std::vector<char> buffer_;
  bool standard_output_ = false;
  int descriptor_ = -1;
};

}  // namespace rtusim::config
