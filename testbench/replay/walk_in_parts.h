#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "testbench/replay/walks.h"

namespace rtusim::replaying {

/// Walks jobs part by part, on any number of threads.
class walk_in_parts {
 public:
  walk_in_parts(const ray_walker& walk, const std::vector<job_packet>& jobs, walked_rays& all)
      : walk_(walk), jobs_(jobs), all_(all), done_((jobs.size() + part - 1) / part) {}

  /// Walks the next part that nobody has begun; false when there is none.
  bool walk_part() {
    const std::size_t n = next_.fetch_add(1, std::memory_order_relaxed);
    if (n >= done_.size()) return false;
    walk_.walk(jobs_.data(), n * part, std::min((n + 1) * part, jobs_.size()), all_);
    done_[n].store(true, std::memory_order_release);
    return true;
  }
  /// All jobs before this one are walked. Called by one thread.
  std::size_t walked_to() {
    while (seen_ < done_.size() && done_[seen_].load(std::memory_order_acquire)) ++seen_;
    return std::min(seen_ * part, jobs_.size());
  }
  /// Lets nobody begin another part.
  void stop() { next_.store(done_.size(), std::memory_order_relaxed); }

 private:
  static constexpr std::size_t part = 2048;

  const ray_walker& walk_;
  const std::vector<job_packet>& jobs_;
  walked_rays& all_;
  std::atomic<std::size_t> next_{0};
  std::vector<std::atomic<bool>> done_;
  std::size_t seen_ = 0;
};

/// Threads that are told to stop and waited for, whatever happens.
class joined_threads {
 public:
  ~joined_threads() {
    for (const auto& stop : stops_) stop();
    join();
  }
  /// Starts none where the system has none left: `work` is help that the others can do without.
  void start(std::function<void()> work, std::function<void()> stop) {
    stops_.push_back(std::move(stop));
    try {
      threads_.emplace_back(std::move(work));
    } catch (const std::system_error&) {
      return;
    }
  }
  void join() {
    for (auto& t : threads_) t.join();
    threads_.clear();
  }

 private:
  std::vector<std::function<void()>> stops_;
  std::vector<std::thread> threads_;
};

}  // namespace rtusim::replaying
