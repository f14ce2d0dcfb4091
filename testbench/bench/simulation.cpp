#include "testbench/bench/simulation.h"

#include <algorithm>
#include <utility>

#include "modules/config/error.h"

namespace rtusim {

simulation::simulation(const design& d, const surroundings& s, const memory_contents& model, const std::vector<job_packet>& jobs, pace p,
                       const std::optional<waveform_window>& window)
    : jobs_(jobs),
      window_(window),
      clock_mhz_(d.rtu.clock_mhz),
      clock_("clock_domain", d.rtu.clock_mhz),
      source_("source", s.source, jobs),
      rtu_("rtu", d, model),
      sink_("sink", s.sink, jobs.size()),
      result_(rtu_.bank().make_result_channel("result")),
      scoreboard_(rtu_.bank(), job_, *result_) {
  source_.out(job_);
  rtu_.job_in(job_);
  sink_.in(*result_);
  if (p == pace::skipping && !window) rtu_.bank().expect(jobs);
  clock_.set_pace(p);
  clock_.set_watchdog(s.watchdog_cycles);
  if (window) {
    waveform_ = std::make_unique<waveform>(window->file, d.kind().packets());
    if (window->job_id)
      follow_job(*window->job_id);
    else
      clock_.record(*waveform_, window->from, window->to);
  }
}

void simulation::follow_job(std::uint32_t job_id) {
  const auto found = std::find_if(jobs_.begin(), jobs_.end(), [job_id](const job_packet& j) { return j.pixel() == job_id; });
  if (found == jobs_.end()) throw input_error("--vcd-job", fmt::format("{}, which no job has", job_id), "the id of a job of this run");
  const auto sequence = static_cast<std::uint32_t>(found - jobs_.begin());
  clock_.record(*waveform_, sequence == 0 ? 0 : never, never);
  scoreboard_.on_accepted([this, sequence](std::uint32_t accepted) {
    if (accepted + 1 == sequence) clock_.start_recording();
  });
  scoreboard_.on_left([this, sequence](std::uint32_t left) {
    if (left == sequence) clock_.stop_recording();
  });
}

void simulation::run() {
  if (jobs_.empty()) throw input_error("jobs", "none", "at least one");
  clock_.start();
  if (waveform_) {
    waveform_->close();
    if (!waveform_->recorded())
      throw input_error("--vcd-from",
                        fmt::format("cycle {}, and the run ends with cycle {}", window_->from, scoreboard_.figures().last_result),
                        "a cycle of the run");
  }
  scoreboard_.check_complete(jobs_.size());
}

run_figures simulation::figures() {
  run_figures f;
  f.clock_mhz = clock_mhz_;
  f.results = scoreboard_.figures();
  for (unit* const u : clock_.units())
    if (auto figures = u->figures()) f.units.push_back({u->basename(), std::move(figures)});
  for (channel_base* ch : clock_.channels()) f.channels.emplace_back(ch->basename(), ch->stats());
  return f;
}

}  // namespace rtusim
