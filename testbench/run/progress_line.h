#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace rtusim {

/// A line on the terminal that tells how far a work is, taken away when it ends; nothing in a pipe.
class progress_line {
 public:
  explicit progress_line(bool wanted) : on_(wanted && isatty(STDERR_FILENO) != 0) {}
  ~progress_line() {
    if (on_) fmt::print(stderr, "\r\033[K");
  }
  progress_line(const progress_line&) = delete;
  progress_line& operator=(const progress_line&) = delete;

  void show(std::string_view text) const {
    if (on_) fmt::print(stderr, "\r\033[K{}", text);
  }
  /// A bar. `share`: done of what is under way, 0 to 1.
  void show(std::string_view what, double share) const {
    constexpr std::size_t width = 40;
    const std::string bar(static_cast<std::size_t>(share * width), '#');
    show(fmt::format("{:<16} [{:<{}}] {:3.0f} %", what, bar, width, 100 * share));
  }

 private:
  bool on_;
};

}  // namespace rtusim
