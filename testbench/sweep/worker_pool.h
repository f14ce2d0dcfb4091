#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace rtusim {

/// What a worker tells at its end.
struct worker_report {
  enum class outcome : char {
    done = 'd',
    failed = 'f',      ///< what it was to do can't be done; `reason` tells why
    unwritable = 'w',  ///< its result could not be written
  };
  outcome how = outcome::done;
  std::string reason;
};

/// Processes that do a piece of work each, so many at a time, copies of this one as it stands when they start. They end with this one, and
/// ignore the signals that `interrupts` notes.
class worker_pool {
 public:
  struct ended {
    std::size_t work;
    worker_report report;
  };

  explicit worker_pool(unsigned most) : most_(most) {}
  /// Kills those that still work.
  ~worker_pool();
  worker_pool(const worker_pool&) = delete;
  worker_pool& operator=(const worker_pool&) = delete;

  bool full() const { return running_.size() >= most_; }
  bool empty() const { return running_.empty(); }

  /// Starts a worker with a piece of work of this number. An exception of `work` is a failure.
  /// Errors: input_error when no process more can be started.
  void start(std::size_t number, const std::function<worker_report()>& work);

  /// Waits for a worker's end; nothing when none came within `patience`, or when a signal did. One that was killed has failed.
  std::optional<ended> next(std::chrono::milliseconds patience);

 private:
  struct worker {
    pid_t process;
    std::size_t work;
  };
  unsigned most_;
  std::map<int, worker> running_;  // by the pipe on which its report comes
};

}  // namespace rtusim
