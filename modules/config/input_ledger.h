#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rtusim::config {

/// A file that was read.
struct input_file {
  std::filesystem::path file;       ///< as it was opened
  std::filesystem::path canonical;  ///< absolute, with links followed; of a pipe as far as it can be told
  std::uint64_t bytes = 0;          ///< as they lie there: zipped, if they are
  std::string sha256;               ///< of these bytes, 64 hexadecimal digits, as `sha256sum` prints them
};

/// Notes, while it lives, every file that `read_file` reads, on any thread of this process: what the checksums are of is what was loaded.
/// Several may live at once: each notes all, and all must end in the order opposite to that in which they began.
class input_ledger {
 public:
  enum class keeping : bool {
    notes,  ///< what was read
    bytes,  ///< and its contents: a file that is read a second time is the same, whatever lies there by then
  };

  /// `most_kept_bytes`: contents are kept while they sum up to no more; a file beyond is noted alone, and read from its place each time.
  explicit input_ledger(keeping what = keeping::notes, std::uint64_t most_kept_bytes = std::numeric_limits<std::uint64_t>::max());
  ~input_ledger();
  input_ledger(const input_ledger&) = delete;
  input_ledger& operator=(const input_ledger&) = delete;

  /// In the order in which they were first read; one that was read again with other contents is there once more.
  std::vector<input_file> files() const;
  /// Their names, as they were opened.
  std::vector<std::filesystem::path> names() const;

  /// What a ledger keeps of this file, else what `read` gives, noted in all that live. For `read_file` alone.
  static std::string read_through(const std::filesystem::path& file, const std::function<std::string()>& read);

 private:
  struct kept_file {
    input_file about;
    std::string bytes;
  };
  void note(const input_file& f);

  keeping what_;
  std::uint64_t room_bytes_;  // for more contents
  std::vector<input_file> files_;
  std::map<std::filesystem::path, std::shared_ptr<const kept_file>> kept_;  // by absolute path
};

/// The SHA-256 of some bytes, 64 hexadecimal digits.
std::string sha256_of(std::string_view bytes);

}  // namespace rtusim::config
