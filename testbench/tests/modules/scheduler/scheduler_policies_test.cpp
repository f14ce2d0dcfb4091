// Each policy of the list, in the scheduler and without a clock, against one that looks at the ports cycle by cycle.

#include "modules/scheduler/scheduler.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/formats/packets.h"
#include "testbench/bench/stream.h"
#include "testbench/replay/schedule_parts.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

/// What surrounds a scheduler. The run ends `tail` cycles after the last job was taken.
struct traffic {
  source_params source;  // not lfsr: what is offered stays
  std::size_t jobs = 1;
  std::vector<cycle> ready_from;           // by core
  std::vector<std::vector<cycle>> pauses;  // by core: cycles in which it is not ready after its first, second ... job; then again
  cycle tail = 0;

  unsigned cores() const { return static_cast<unsigned>(ready_from.size()); }
  cycle pause(unsigned core, std::size_t job) const { return pauses[core][job % pauses[core].size()]; }
};

/// What is seen of a run: each job's cycle and core, and each channel's cycles with valid and with ready.
class sightings {
 public:
  void taken(cycle c, unsigned core, std::size_t job) { text_ += fmt::format("cycle {} core {} job {}\n", c, core, job); }
  void counted(std::string_view channel, std::uint64_t valid, std::uint64_t ready) {
    text_ += fmt::format("{} valid {} ready {}\n", channel, valid, ready);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// ---- the unit

/// Ends the simulation.
class closing final : public unit {
 public:
  explicit closing(const sc_core::sc_module_name& name) : unit(name) {}
  void end_after(cycle c) { book_edge(c); }
  void booked_edge() override { domain().stop(); }

 private:
  void reset() override {}
  bool level(const channel_base&) const override { return false; }
  void trace(waveform&) const override {}
};

/// Takes a job, pauses, and takes the next.
class pausing_core final : public unit {
 public:
  rv_in<traversal_job> job_in{"job_in"};

  pausing_core(const sc_core::sc_module_name& name, const traffic& t, unsigned index)
      : unit(name), traffic_(t), index_(index), ready_from_(t.ready_from[index]) {}

  void arrives(channel_base&) override {
    ready_from_ = now() + 1 + traffic_.pause(index_, jobs_++);
    publish(now() + 1);
  }
  void booked_edge() override { publish(now() + 1); }

 private:
  void reset() override { publish(0); }
  void publish(cycle next) {
    job_in->offer_ready(ready_from_ <= next ? offer::always_from(next) : offer::none());
    if (ready_from_ > next) book_edge(ready_from_ - 1);
  }
  bool level(const channel_base&) const override { return next_edge() >= ready_from_; }
  void trace(waveform&) const override {}

  const traffic& traffic_;
  unsigned index_;
  std::size_t jobs_ = 0;
  cycle ready_from_;
};

struct observer {
  sightings& seen;
  closing& end;
  const traffic& run;
  std::size_t jobs = 0;

  void transferred(unsigned core, cycle c, const traversal_job& job) {
    seen.taken(c, core, job.sequence);
    if (++jobs == run.jobs) end.end_after(c + run.tail);
  }
};

std::string simulated(unsigned policy, const traffic& t, pace p) {
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    std::vector<traversal_job> jobs(t.jobs);
    for (std::uint32_t n = 0; n < jobs.size(); ++n) jobs[n].sequence = n;
    stream_source<traversal_job> source("source", t.source, jobs);
    scheduler_params params;
    params.select = policy;
    scheduler<traversal_job> unit("scheduler", params, t.cores());
    sc_core::sc_vector<pausing_core> cores("core", t.cores(),
                                           [&t](const char* n, std::size_t i) { return new pausing_core(n, t, static_cast<unsigned>(i)); });
    closing end("closing");
    channel<traversal_job> pending("pending");
    sc_core::sc_vector<channel<traversal_job>> core_job("core_job", t.cores(),
                                                        [](const char* n, std::size_t) { return new channel<traversal_job>(n); });
    sightings seen;
    observer watch{seen, end, t};
    source.out(pending);
    unit.job_in(pending);
    for (unsigned i = 0; i < t.cores(); ++i) {
      unit.core_out[i](core_job[i]);
      cores[i].job_in(core_job[i]);
      core_job[i].observe(watch, i);
    }
    clock.set_pace(p);
    clock.start();
    const auto count = [&seen](channel_base& c) {
      const channel_stats s = c.stats();
      seen.counted(c.basename(), s.transferred + s.back_pressured, s.transferred + s.starved);
    };
    count(pending);
    for (auto& c : core_job) count(c);
    return seen.text();
  });
}

// ---- the policy without a clock

/// What a schedule knows of the cores: all, or no more than it asked for.
template <bool Ahead>
struct core_view {
  static constexpr bool known_ahead = Ahead;
  std::vector<cycle>& free_from_;
  std::vector<cycle>& told_;
  cycle& asked_;

  cycle free_from(unsigned core) const { return Ahead ? free_from_[core] : told_[core]; }
  void know(cycle c) const {
    asked_ = std::max(asked_, c);
    for (std::size_t i = 0; i < told_.size(); ++i)
      if (free_from_[i] <= c) told_[i] = free_from_[i];
  }
};

template <class Policy, bool Ahead>
std::string scheduled(const traffic& t) {
  typename Policy::schedule policy(t.cores());
  replaying::source_schedule source(t.source);
  std::vector<cycle> free_from = t.ready_from, told(t.cores(), never);
  std::vector<std::size_t> jobs(t.cores());
  std::vector<std::uint64_t> ready(t.cores());
  cycle asked = 0, end = 0;
  const core_view<Ahead> cores{free_from, told, asked};
  sightings seen;
  for (std::size_t job = 0; job < t.jobs; ++job) {
    const cycle taken = policy.dispatch(source.offered_from(), cores);
    RTU_CHECK(asked, <=, taken);
    const unsigned core = policy.core();
    RTU_CHECK(free_from[core], <=, taken);
    seen.taken(taken, core, job);
    source.accept(taken);
    ready[core] += taken - free_from[core] + 1;
    free_from[core] = taken + 1 + t.pause(core, jobs[core]++);
    told[core] = never;
    end = taken + t.tail + 1;
  }
  cores.know(never);
  seen.counted("pending", source.valid_cycles(), policy.ready_cycles(end, cores));
  for (unsigned i = 0; i < t.cores(); ++i)
    seen.counted(fmt::format("core_job_{}", i), policy.valid_cycles(i), ready[i] + cycles_from(free_from[i], 0, end));
  return seen.text();
}

std::string scheduled(unsigned policy, const traffic& t, bool known_ahead) {
  return scheduler_policies::with(policy, [&](auto p) {
    using type = typename decltype(p)::type;
    return known_ahead ? scheduled<type, true>(t) : scheduled<type, false>(t);
  });
}

// ---- what the policies' words say

/// A cycle at the scheduler's outputs, and what went before.
struct moment {
  cycle now = 0;
  std::vector<bool> ready;   // by core
  std::vector<cycle> taken;  // by core: when it took its last job; never if it took none
  std::size_t jobs = 0;      // that were taken
};

/// The core to which a job is shown; the number of cores if to none.
unsigned shown_to(std::string_view policy, const moment& m) {
  const auto cores = static_cast<unsigned>(m.ready.size());
  if (policy == "cyclic_first_available") return static_cast<unsigned>(m.now % cores);
  if (policy == "round_robin") return static_cast<unsigned>(m.jobs % cores);
  if (policy == "first_available") return static_cast<unsigned>(std::find(m.ready.begin(), m.ready.end(), true) - m.ready.begin());
  if (policy == "least_recently_used") {
    const auto ago = [&m](unsigned core) { return m.taken[core] == never ? m.now + 1 : m.now - m.taken[core]; };
    unsigned found = cores;
    for (unsigned core = 0; core < cores; ++core)
      if (m.ready[core] && (found == cores || ago(core) > ago(found))) found = core;
    return found;
  }
  throw std::logic_error("nobody says what this policy does: " + std::string(policy));
}

std::string expected(std::string_view policy, const traffic& t) {
  const unsigned cores = t.cores();
  moment m;
  m.taken.assign(cores, never);
  std::vector<cycle> ready_from = t.ready_from;
  std::vector<std::size_t> jobs(cores);
  std::vector<std::uint64_t> valid_cycles(cores), ready_cycles(cores);
  std::uint64_t pending_valid = 0, pending_ready = 0;
  cycle offered_from = 0, end = never;
  sightings seen;
  for (; m.now < end; ++m.now) {
    m.ready.clear();
    for (unsigned i = 0; i < cores; ++i) m.ready.push_back(m.now >= ready_from[i]);
    const unsigned core = shown_to(policy, m);
    const bool valid = m.jobs < t.jobs && m.now >= offered_from, ready = core < cores && m.ready[core];
    pending_valid += valid;
    pending_ready += ready;
    for (unsigned i = 0; i < cores; ++i) {
      valid_cycles[i] += valid && i == core;
      ready_cycles[i] += m.ready[i];
    }
    if (!valid || !ready) continue;
    seen.taken(m.now, core, m.jobs++);
    m.taken[core] = m.now;
    ready_from[core] = m.now + 1 + t.pause(core, jobs[core]++);
    if (m.jobs == t.jobs) end = m.now + t.tail + 1;
    switch (t.source.valid) {
      case source_params::regime::always:
      case source_params::regime::lfsr: offered_from = m.now + 1; break;
      case source_params::regime::gap: offered_from = m.now + 1 + t.source.gap_cycles; break;
      case source_params::regime::paced: offered_from = std::max(offered_from + t.source.interval_cycles, m.now + 1); break;
    }
  }
  seen.counted("pending", pending_valid, pending_ready);
  for (unsigned i = 0; i < cores; ++i) seen.counted(fmt::format("core_job_{}", i), valid_cycles[i], ready_cycles[i]);
  return seen.text();
}

traffic random_traffic(test::rng& random, unsigned cores) {
  traffic t;
  t.source.valid = static_cast<source_params::regime>(random() % 3);
  t.source.gap_cycles = 1 + random() % (random() % 4 == 0 ? 300 : 6);
  t.source.interval_cycles = 1 + random() % 12;
  t.jobs = 1 + random() % (6 * cores + 20);
  t.tail = random() % 4 == 0 ? 0 : random() % (3 * cores + 3);
  // From cores that are always ready to ones that take many turns of a select.
  const std::uint32_t longest = random() % 8 == 0 ? 1 : 1 + random() % (random() % 4 == 0 ? 20 * cores + 2 : 3 * cores + 2);
  for (unsigned i = 0; i < cores; ++i) {
    t.ready_from.push_back(random() % 2 == 0 ? 0 : random() % (2 * cores + 3));
    auto& pauses = t.pauses.emplace_back(1 + random() % 7);
    for (cycle& p : pauses) p = random() % longest;
  }
  return t;
}

}  // namespace

TEST_CASE("scheduler policies: each has a word of its own, and the hardware's is the default", "[scheduler]") {
  auto names = scheduler_policies::names();
  REQUIRE(names.size() == scheduler_policies::count);
  CHECK(names[scheduler_params{}.select] == "cyclic_first_available");
  for (unsigned i = 0; i < scheduler_policies::count; ++i)
    scheduler_policies::with(i, [&](auto p) {
      using type = typename decltype(p)::type;
      CHECK(type::name == names[i]);
      CHECK(policy_index<type> == i);
    });
  CHECK_THROWS_AS(scheduler_policies::with(scheduler_policies::count, [](auto) {}), simulation_error);
  std::sort(names.begin(), names.end());
  CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("scheduler policies: whom a job is shown to and who takes it, whatever source and cores do", "[scheduler]") {
  test::rng random(5'150);
  const auto names = scheduler_policies::names();
  for (const unsigned cores : {1u, 2u, 3u, 4u, 7u, 16u, 64u, 65u})
    for (int round = 0; round < 4; ++round) {
      const traffic t = random_traffic(random, cores);
      for (unsigned policy = 0; policy < scheduler_policies::count; ++policy) {
        CAPTURE(cores, round, names[policy]);
        const std::string wanted = expected(names[policy], t);
        for (const pace p : {pace::skipping, pace::checked}) {
          CAPTURE(static_cast<int>(p));
          REQUIRE(simulated(policy, t, p) == wanted);
        }
      }
    }
}

TEST_CASE("scheduler policies: least recently used is the core without a job so far, then the one whose last began first", "[scheduler]") {
  traffic t;
  t.jobs = 9;
  t.ready_from = {0, 0, 0};
  t.pauses = {{1}, {4}, {1}};
  const unsigned cores[] = {0, 1, 2, 0, 2, 0, 1, 2, 0};  // in cycle 6 cores 1 and 2 are ready, in cycle 7 cores 0 and 2
  sightings wanted;
  for (cycle c = 0; c < t.jobs; ++c) wanted.taken(c, cores[c], c);
  const unsigned policy = policy_index<least_recently_used>;
  CHECK_THAT(simulated(policy, t, pace::checked), Catch::StartsWith(wanted.text()));
  CHECK_THAT(scheduled(policy, t, true), Catch::StartsWith(wanted.text()));
  CHECK_THAT(expected("least_recently_used", t), Catch::StartsWith(wanted.text()));
}

TEST_CASE("scheduler policies: a schedule finds the same cycles and counts without a clock", "[scheduler]") {
  test::rng random(2'001);
  const auto names = scheduler_policies::names();
  for (const unsigned cores : {1u, 2u, 3u, 4u, 5u, 8u, 13u, 64u, 65u})
    for (int round = 0; round < 40; ++round) {
      const traffic t = random_traffic(random, cores);
      for (unsigned policy = 0; policy < scheduler_policies::count; ++policy) {
        CAPTURE(cores, round, names[policy]);
        const std::string wanted = expected(names[policy], t);
        REQUIRE(scheduled(policy, t, true) == wanted);
        REQUIRE(scheduled(policy, t, false) == wanted);
      }
    }
}

}  // namespace rtusim
