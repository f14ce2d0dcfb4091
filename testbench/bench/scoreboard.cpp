#include "testbench/bench/scoreboard.h"

#include "modules/config/error.h"

namespace rtusim {

scoreboard::scoreboard(core_bank& bank, channel<job_packet>& jobs, channel_base& results) : bank_(bank), flights_(64) {
  jobs.observe_as<job_packet, &scoreboard::accepted>(*this, 0);
  for (unsigned i = 0; i < bank.cores(); ++i) {
    bank.core_job_channel(i).observe_as<core_job, &scoreboard::dispatched>(*this, i);
    bank.core_result_channel(i).observe_as<traversal_result, &scoreboard::buffered>(*this, i);
  }
  results.observe_as<traversal_result, &scoreboard::left>(*this, 0);
}

void scoreboard::accepted(unsigned, cycle c, const job_packet& p) {
  if (jobs_accepted_ == 0) {
    job_latency_cycles_ = bank_.job_timing().latency_cycles;
    core_latency_cycles_ = bank_.core_timing().latency_cycles;
  }
  // Rays leave out of order, so a slot can be busy although fewer than the ring's are in flight: then the ring grows.
  if (in_flight(jobs_accepted_).accepted != never) {
    std::vector<flight> more(flights_.size() * 2);
    for (std::uint32_t s = jobs_accepted_ - static_cast<std::uint32_t>(flights_.size()); s != jobs_accepted_; ++s)
      more[s & (more.size() - 1)] = in_flight(s);
    flights_ = std::move(more);
  }
  in_flight(jobs_accepted_++) = {p.job_word, 0, c, never, never};
  if (accepted_handler_) accepted_handler_(jobs_accepted_ - 1);
  figures_.last_accepted = c;
}

void scoreboard::dispatched(unsigned core, cycle c, const core_job& j) {
  flight& f = in_flight(j.sequence);
  RTU_CHECK(f.job_word, ==, j.job_word);
  RTU_CHECK(j.sequence, ==, jobs_dispatched_);
  ++jobs_dispatched_;
  f.dispatched = c;
  f.core = core;
}

void scoreboard::buffered(unsigned core, cycle c, const traversal_result& r) {
  flight& f = in_flight(r.sequence);
  RTU_CHECK(f.job_word, ==, r.job_word);
  RTU_CHECK(f.core, ==, core);
  RTU_CHECK(f.buffered, ==, never);
  f.buffered = c;
}

void scoreboard::left(unsigned, cycle c, const traversal_result& r) {
  flight& f = in_flight(r.sequence);
  RTU_CHECK(f.job_word, ==, r.job_word);
  RTU_CHECK(static_cast<std::uint32_t>(r.core), ==, f.core);
  const cycle converted = f.accepted + job_latency_cycles_;
  const cycle walked = f.dispatched + r.cost + core_latency_cycles_;
  RTU_CHECK(f.dispatched, >=, converted);
  RTU_CHECK(f.buffered, >=, walked);
  RTU_CHECK(c, >, f.buffered);
  const ray_waits waits{job_latency_cycles_, f.dispatched - converted, r.cost + core_latency_cycles_, f.buffered - walked, c - f.buffered};
  RTU_CHECK(waits.latency_cycles(), ==, c - f.accepted);

  figures_.count(c, r, waits.latency_cycles());
  figures_.waits += waits;
  f = {};
  if (handler_) handler_(c, r, waits.latency_cycles());
  if (left_handler_) left_handler_(r.sequence);
}

void scoreboard::check_complete(std::uint64_t jobs) const {
  RTU_CHECK(static_cast<std::uint64_t>(jobs_accepted_), ==, jobs);
  RTU_CHECK(figures_.rays, ==, jobs);
  for (const flight& f : flights_) RTU_CHECK(f.accepted, ==, never);
}

void ray_waits::describe(config::report& r, double rays) const {
  const auto mean = [rays](std::uint64_t sum) { return rays == 0 ? 0.0 : static_cast<double>(sum) / rays; };
  r.number("conversion", mean(conversion_cycles), "cycles/ray", "in the job manager's stages");
  r.number("dispatch", mean(dispatch_cycles), "cycles/ray", "in the job manager, until a core takes the job");
  r.number("traversal", mean(traversal_cycles), "cycles/ray", "in the core's states, and in the intersector behind a triangle core");
  r.number("buffer", mean(buffer_cycles), "cycles/ray", "in the core, until its result buffer is empty");
  r.number("result", mean(result_cycles), "cycles/ray", "in the result buffer, until the result leaves");
}

}  // namespace rtusim
