#include "testbench/replay/replay.h"

#include <memory>
#include <thread>

#include "modules/config/error.h"
#include "testbench/replay/walk_in_parts.h"

namespace rtusim {
namespace {

/// All but the caller's own.
void start_others(replaying::joined_threads& others, replaying::walk_in_parts& walks, unsigned threads) {
  for (unsigned n = 1; n < threads; ++n)
    others.start(
        [&walks] {
          while (walks.walk_part()) {}
        },
        [&walks] { walks.stop(); });
}

}  // namespace

std::string replay_obstacle(const design& d, const surroundings& s) {
  if (const std::string why = d.kind().replay_obstacle(); !why.empty()) return why;
  if (s.sink.ready == sink_params::regime::blocked) return "sink.ready = never";
  return {};
}

void check_replayable(const design& d, const surroundings& s) {
  if (const std::string why = replay_obstacle(d, s); !why.empty())
    throw input_error("--pace replay", why, "a design whose schedule follows from the costs of its rays; --pace skipping takes every one");
}

std::unique_ptr<walked_rays> walk_rays(const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads) {
  auto all = walk.room(jobs.size());
  replaying::walk_in_parts walks(walk, jobs, *all);
  replaying::joined_threads others;
  start_others(others, walks, threads);
  while (walks.walk_part()) {}
  others.join();
  return all;
}

run_figures replay(const design& d, const surroundings& s, const ray_walker& walk, const walked_rays& walked,
                   const result_handler& handler) {
  check_replayable(d, s);
  const auto schedule = walk.schedule(d, s, walked, handler);
  schedule->advance(walked.size());
  return schedule->finish();
}

run_figures replay(const design& d, const surroundings& s, const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads,
                   const result_handler& handler) {
  check_replayable(d, s);
  const auto walked = walk.room(jobs.size());
  const auto schedule = walk.schedule(d, s, *walked, handler);
  replaying::walk_in_parts walks(walk, jobs, *walked);
  replaying::joined_threads others;
  start_others(others, walks, threads);
  for (std::size_t walked_to = 0; walked_to < jobs.size();) {
    const std::size_t end = walks.walked_to();
    if (end == walked_to && !walks.walk_part()) std::this_thread::yield();
    schedule->advance(end);
    walked_to = end;
  }
  others.join();
  return schedule->finish();
}

}  // namespace rtusim
