#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rtusim {

/// What a worker tells at the end of a piece of work.
struct worker_report {
  enum class outcome : char {
    done = 'd',
    failed = 'f',      ///< what it was to do can't be done; `reason` tells why
    unwritable = 'w',  ///< its result could not be written
    not_begun = 'n',   ///< the worker ended before
  };
  outcome how = outcome::done;
  std::string reason;
};

/// Processes, so many at a time, that do some pieces of work each, one after the other: copies of this one as it stands when they start.
/// They end with this one, and ignore the signals that `interrupts` notes.
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
  bool empty() const { return running_.empty() && ended_.empty(); }

  /// Starts a worker with pieces of work of these numbers. An exception of `work` is a failure of that piece.
  /// Errors: input_error when no process more can be started.
  void start(std::vector<std::size_t> numbers, const std::function<worker_report(std::size_t)>& work);

  /// Waits for the end of a piece of work; nothing when none came within `patience`, or when a signal did. That of one that was killed has
  /// failed.
  std::optional<ended> next(std::chrono::milliseconds patience);

 private:
  struct worker {
    pid_t process;
    std::vector<std::size_t> work;
    std::size_t told = 0;  // pieces
    std::string said;      // and what is no whole report yet
  };
  void hear(int pipe);
  void bury(int pipe);

  unsigned most_;
  std::map<int, worker> running_;  // by the pipe on which its reports come
  std::deque<ended> ended_;
};

}  // namespace rtusim
