#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "modules/formats/packets.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/rtu/design.h"
#include "testbench/bench/run_figures.h"
#include "testbench/bench/scoreboard.h"
#include "testbench/bench/surroundings.h"

namespace rtusim {

/// What a ray's traversal comes to, without the design's timing. Has no initial values: a frame's are written by the threads that
/// walk, and not before.
struct walked_ray {
  std::int64_t t_hit;  ///< of a hit
  std::uint32_t job_word;
  std::uint32_t cost;
  std::uint32_t pushes;
  std::uint8_t depth;
  std::int8_t axis;  ///< of a hit
  bool hit;
  bool overflow;
};

/// The walks of all jobs of a run, in their order. They serve every core count, policy, source and sink.
struct walked_rays {
  explicit walked_rays(std::size_t count) : rays(new walked_ray[count]), size(count) {}

  std::unique_ptr<walked_ray[]> rays;
  std::size_t size;
  numeric::float_to_fixed_stats conversion;
};

namespace replaying {

/// A replay that goes on as rays are walked.
class job_schedule {
 public:
  virtual ~job_schedule() = default;
  /// Follows the jobs before `end`, which are walked.
  virtual void advance(std::size_t end) = 0;
  virtual run_figures finish(const numeric::float_to_fixed_stats& conversion) = 0;
};

}  // namespace replaying

/// Walks rays through a model, without time, and knows the schedule that their kind of core keeps. Threads may share it.
class ray_walker {
 public:
  virtual ~ray_walker() = default;
  /// Converts and walks `count` jobs; adds to `conversion`.
  virtual void operator()(const job_packet* jobs, std::size_t count, walked_ray* to, numeric::float_to_fixed_stats& conversion) const = 0;
  /// The schedule of a run of which `walked` is to have the walks; see `replaying::schedule_for`. All arguments must outlive it.
  virtual std::unique_ptr<replaying::job_schedule> schedule(const design& d, const surroundings& s, const walked_rays& walked,
                                                            const result_handler& handler) const = 0;
};

/// Walks all jobs, to keep the walks for several designs. The outcome does not depend on the number of threads.
walked_rays walk_rays(const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads);

}  // namespace rtusim
