#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "modules/formats/packets.h"
#include "modules/rtu/design.h"
#include "testbench/bench/run_figures.h"
#include "testbench/bench/scoreboard.h"
#include "testbench/bench/surroundings.h"

namespace rtusim {

/// What becomes of all jobs of a run, in their order, without the design's timing. It serves every core count, policy, source and sink.
/// What a kind of core keeps of a ray is its own: see `walked_as`.
class walked_rays {
 public:
  virtual ~walked_rays() = default;
  walked_rays(const walked_rays&) = delete;
  walked_rays& operator=(const walked_rays&) = delete;

  std::size_t size() const { return size_; }

 protected:
  explicit walked_rays(std::size_t size) : size_(size) {}

 private:
  std::size_t size_;
};

/// `Ray` has no initial values: a frame's are written by the threads that walk, and not before. `Jobs`: what a job manager counts.
template <class Ray, class Jobs>
class walked_as final : public walked_rays {
 public:
  explicit walked_as(std::size_t count) : walked_rays(count), rays(new Ray[count]) {}
  void add(const Jobs& counted) {
    const std::lock_guard lock(adding_);
    jobs += counted;
  }

  std::unique_ptr<Ray[]> rays;
  Jobs jobs;

 private:
  std::mutex adding_;
};

namespace replaying {

/// A replay that goes on as rays are walked.
class job_schedule {
 public:
  virtual ~job_schedule() = default;
  /// Follows the jobs before `end`, which are walked.
  virtual void advance(std::size_t end) = 0;
  /// All are.
  virtual run_figures finish() = 0;
};

}  // namespace replaying

/// Walks rays through a model, without time, and knows the schedule that their kind of core keeps. Threads may share it.
class ray_walker {
 public:
  virtual ~ray_walker() = default;
  /// Where the walks of so many jobs go.
  virtual std::unique_ptr<walked_rays> room(std::size_t jobs) const = 0;
  /// Makes ready and walks the jobs [first, end).
  virtual void walk(const job_packet* jobs, std::size_t first, std::size_t end, walked_rays& to) const = 0;
  /// The schedule of a run of which `walked` is to have the walks; see `replaying::schedule_for`. All arguments must outlive it.
  virtual std::unique_ptr<replaying::job_schedule> schedule(const design& d, const surroundings& s, const walked_rays& walked,
                                                            const result_handler& handler) const = 0;
};

/// Walks all jobs, to keep the walks for several designs. The outcome does not depend on the number of threads.
std::unique_ptr<walked_rays> walk_rays(const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads);

}  // namespace rtusim
