#pragma once

#include <array>
#include <csignal>

namespace rtusim {

/// While this lives, SIGINT, SIGTERM and SIGHUP do not end the process: they are noted, and a call that waits returns with EINTR. One that
/// was ignored before (`nohup`, a job in the background) stays so. One of this at a time.
class interrupts {
 public:
  interrupts();
  ~interrupts();
  interrupts(const interrupts&) = delete;
  interrupts& operator=(const interrupts&) = delete;

  /// Whether one came.
  static bool came();
  /// For a child whose parent sees to its end: ignores all three.
  static void leave_to_parent();

 private:
  static constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_{};
};

}  // namespace rtusim
