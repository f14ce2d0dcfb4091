#include "testbench/simulation.h"

#include <algorithm>

#include "modules/config/error.h"

namespace rtusim {

void surroundings::describe(config::schema& s) {
  s.add("source", source);
  s.add("sink", sink);
  s.add("watchdog", watchdog_);
}

const std::set<std::string>& surroundings::sections() {
  static const std::set<std::string> names{"source", "sink", "watchdog"};
  return names;
}

simulation::simulation(const design& d, const surroundings& s, const std::vector<std::uint32_t>& image, const std::vector<job_packet>& jobs,
                       pace p, const std::optional<waveform_window>& window)
    : jobs_(jobs),
      window_(window),
      clock_("clock_domain", d.rtu.clock_mhz),
      source_("source", s.source, jobs),
      rtu_("rtu", d, image),
      sink_("sink", s.sink, jobs.size()),
      scoreboard_(rtu_, job_, result_) {
  source_.out(job_);
  rtu_.job_in(job_);
  rtu_.result_out(result_);
  sink_.in(result_);
  clock_.set_pace(p);
  clock_.set_watchdog(s.watchdog_cycles);
  if (window) {
    waveform_ = std::make_unique<waveform>("waveform", window->file);
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
      throw input_error("--vcd-from", fmt::format("cycle {}, and the run ends with cycle {}", window_->from, total_cycles()), "a cycle of the run");
  }
  scoreboard_.check_complete(jobs_.size());
}

void simulation::describe_statistics(config::report& r) {
  const auto rays = static_cast<double>(scoreboard_.results());
  const auto cycles = static_cast<double>(total_cycles());
  const double hz = 1e6 / (clock_.period().to_seconds() * 1e6);
  r.number("total_cycles", total_cycles(), "cycles", "cycle of the last result; cycle 0 accepts the first job");
  r.number("last_accept_cycle", scoreboard_.last_accepted(), "cycles", "cycle that accepts the last job");
  r.number("rays", scoreboard_.results(), "rays", "jobs, each with its result");
  r.number("hits", scoreboard_.hits(), "rays", "rays that hit");
  r.number("cycles_per_ray", cycles / rays, "cycles", "total cycles by rays");
  r.number("rays_per_cycle", rays / cycles, "rays", "rays by total cycles");
  r.number("seconds", cycles / hz, "s", "total cycles at the clock");
  r.number("rays_per_second", rays * hz / cycles, "1/s", "rays at the clock");
  r.number("frames_per_second", hz / cycles, "1/s", "runs like this one at the clock");
  r.number("checksum", fmt::format("{:016x}", scoreboard_.checksum()), "", "over job word, hit, cost, cycle and t of all results, in order");
  r.group("latency", [this](config::report& g) { scoreboard_.latency().describe(g, "cycles"); });
  r.group("cost", [this](config::report& g) { scoreboard_.cost().describe(g, "cycles"); });
  r.group("waits", [&](config::report& g) { scoreboard_.waits().describe(g, rays); });
  rtu_.describe_statistics(r);
  r.group("channels", [this](config::report& g) {
    for (channel_base* ch : clock_.channels()) g.group(ch->basename(), [ch](config::report& c) { ch->stats().describe(c); });
  });
}

}  // namespace rtusim
