#include "testbench/replay/replay.h"

#include <memory>
#include <thread>

#include "modules/config/error.h"
#include "modules/scheduler/policies/policies.h"
#include "testbench/replay/schedule.h"
#include "testbench/replay/walk_in_parts.h"

namespace rtusim {
namespace {

using namespace replaying;

template <bool Held>
std::unique_ptr<job_schedule> schedule_of(const design& d, const surroundings& s, const walked_rays& walked,
                                          const result_handler& handler) {
  return scheduler_policies::with(d.scheduler_.select, [&](auto policy) -> std::unique_ptr<job_schedule> {
    return std::make_unique<schedule<Held, typename decltype(policy)::type>>(d, s, walked, handler);
  });
}

std::unique_ptr<job_schedule> schedule_for(const design& d, const surroundings& s, const walked_rays& walked,
                                           const result_handler& handler) {
  check_replayable(d, s);
  const bool always = s.sink.ready == sink_params::regime::always;
  const bool held = !d.result_manager_.valid_withdrawn && !always;
  return held ? schedule_of<true>(d, s, walked, handler) : schedule_of<false>(d, s, walked, handler);
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

walked_rays walk_rays(const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads) {
  walked_rays all(jobs.size());
  walk_in_parts walks(walk, jobs, all);
  std::vector<std::thread> others;
  for (unsigned n = 1; n < threads; ++n) others.emplace_back([&walks] { while (walks.walk_part()) {} });
  while (walks.walk_part()) {}
  for (auto& t : others) t.join();
  return all;
}

run_figures replay(const design& d, const surroundings& s, const walked_rays& walked, const result_handler& handler) {
  const auto schedule = schedule_for(d, s, walked, handler);
  schedule->advance(walked.size);
  return schedule->finish(walked.conversion);
}

run_figures replay(const design& d, const surroundings& s, const ray_walker& walk, const std::vector<job_packet>& jobs, unsigned threads,
                   const result_handler& handler) {
  walked_rays walked(jobs.size());
  const auto schedule = schedule_for(d, s, walked, handler);
  walk_in_parts walks(walk, jobs, walked);
  joined_threads others;
  for (unsigned n = 1; n < threads; ++n) others.start([&walks] { while (walks.walk_part()) {} }, [&walks] { walks.stop(); });
  for (std::size_t walked_to = 0; walked_to < jobs.size();) {
    const std::size_t end = walks.walked_to();
    if (end == walked_to && !walks.walk_part()) std::this_thread::yield();
    schedule->advance(end);
    walked_to = end;
  }
  others.join();
  return schedule->finish(walked.conversion);
}

}  // namespace rtusim
