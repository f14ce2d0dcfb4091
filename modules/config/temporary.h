#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rtusim::config {

/// `HOST-PID-START`: this process among all that ever write into a folder, on any machine. HOST is the machine's name, its letters and
/// digits as they are and the rest as `%2d`; START is when the process began, in clock ticks since its machine did.
std::string process_mark();

/// Whether a mark is that of a process of this machine that is no more. One that can't be asked about counts as alive.
bool is_of_dead_process(std::string_view mark);

/// The name of a file beside its place, which it takes when it is whole: `.STEM.part-HOST-PID-START-N.EXT`, with N from 0 to tell those of
/// one process apart. While this lives, a signal that ends the process removes the file, and so does the destructor unless it was kept.
/// As many as 64 at a time; a file beyond these is left to `remove_leftovers` if a signal comes.
class temporary_file {
 public:
  temporary_file(const std::filesystem::path& target, unsigned number);
  ~temporary_file();
  temporary_file(const temporary_file&) = delete;
  temporary_file& operator=(const temporary_file&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// It has been renamed, or was never made.
  void keep();

 private:
  static constexpr unsigned unlisted = ~0u;
  std::filesystem::path path_;
  unsigned slot_ = unlisted;
};

/// Removes the files of `temporary_file`'s names in a folder that dead processes of this machine left, and no other. A folder that was
/// looked through before, or can't be, is passed over.
void remove_leftovers(const std::filesystem::path& folder);

/// Removes the files of all `temporary_file`s of this process. May be called in a signal's handler.
void remove_temporaries() noexcept;

/// From now on SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGXCPU, unless they are ignored, remove the temporary files before they end the
/// process; a write to a closed pipe, or beyond the largest size of a file, is an error in place of a signal.
void remove_temporaries_on_signals();

}  // namespace rtusim::config
