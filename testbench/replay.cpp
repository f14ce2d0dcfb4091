#include "testbench/replay.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "modules/config/error.h"
#include "modules/svo_core/svo_walk.h"
#include "modules/timing/lfsr.h"

namespace rtusim {
namespace {

constexpr unsigned stages = job_manager::latency_cycles;

/// Division of small numbers by N without dividing.
class divider {
 public:
  explicit divider(unsigned n) : n_(n), reciprocal_(((std::uint64_t{1} << 32) + n - 1) / n) {}
  std::uint64_t quotient(std::uint64_t x) const { return x < 65'536 ? x * reciprocal_ >> 32 : x / n_; }
  unsigned remainder(std::uint64_t x) const { return static_cast<unsigned>(x - quotient(x) * n_); }

 private:
  std::uint64_t n_;
  std::uint64_t reciprocal_;
};

/// When the source offers the next job.
class source_schedule {
 public:
  explicit source_schedule(const source_params& p) : params_(p) {
    if (p.valid == source_params::regime::lfsr) random_.emplace(p.seed);
  }

  cycle offered_from() const { return from_; }
  cycle next(cycle c) const { return random_ ? random_->next(c) : c; }
  void accept(cycle c) {
    valid_cycles_ += random_ ? random_->count(from_, c + 1) : c + 1 - from_;
    switch (params_.valid) {
      case source_params::regime::always:
      case source_params::regime::lfsr: from_ = c + 1; break;
      case source_params::regime::gap: from_ = c + 1 + params_.gap_cycles; break;
      case source_params::regime::paced: from_ = std::max(from_ + params_.interval_cycles, c + 1); break;
    }
  }
  std::uint64_t valid_cycles() const { return valid_cycles_; }

 private:
  source_params params_;
  std::optional<lfsr> random_;
  cycle from_ = 0;
  std::uint64_t valid_cycles_ = 0;
};

/// The job manager's stages, which stand still from the cycle in which a job is at the output to the one that dispatches it.
class stages_schedule {
 public:
  /// The first cycle >= c in which the stages move, so that a job can be accepted.
  cycle next_move(cycle c) {
    while (first_ != last_ && stall(first_).to <= c) {
      stalled_before_ += stall(first_).to - stall(first_).from;
      ++first_;
    }
    return first_ != last_ && stall(first_).from <= c ? stall(first_).to : c;
  }
  /// The cycle from which on a job accepted in cycle c, a result of `next_move`, is at the output.
  cycle output_from(cycle c) {
    next_move(c);
    return c + stages + (stalled_ - stalled_before_);
  }
  /// A job at the output from cycle `from` on is dispatched in cycle `to`.
  void dispatch(cycle from, cycle to) {
    if (from == to) return;
    stall(last_++) = {from, to};
    stalled_ += to - from;
  }
  std::uint64_t stalled() const { return stalled_; }

 private:
  struct interval { cycle from, to; };  // stands still in [from, to)
  interval& stall(std::uint64_t i) { return stalls_[i % stalls_.size()]; }

  std::array<interval, 8> stalls_{};  // no more than the stages can hold lie ahead of a job being accepted
  std::uint64_t first_ = 0, last_ = 0;
  std::uint64_t stalled_ = 0;         // cycles of all stalls so far
  std::uint64_t stalled_before_ = 0;  // and of those before `first_`
};

/// Puts results into the order of leaving, one a cycle at most.
class leaving_order {
 public:
  struct result {
    std::uint32_t job = 0;
    std::uint32_t core = 0;
    std::uint64_t latency_cycles = 0;
  };

  void add(cycle c, const result& r) {
    while (c - base_ >= ring_.size()) grow();
    const std::size_t slot = c & (ring_.size() - 1);
    ring_[slot] = r;
    taken_[slot / 64] |= std::uint64_t{1} << (slot % 64);
  }
  /// Cycles from the first not handed out to `end`. It pays to hand out many at once.
  cycle span(cycle end) const { return end - base_; }
  static constexpr cycle batch = 2048;

  /// Hands out the results of all cycles before `end`.
  template <class Handler>
  void flush(cycle end, Handler&& handler) {
    while (base_ < end) {
      const std::size_t slot = base_ & (ring_.size() - 1);
      const std::size_t span = std::min<cycle>(64 - slot % 64, end - base_);
      std::uint64_t& word = taken_[slot / 64];
      std::uint64_t bits = word >> (slot % 64);
      if (span < 64) bits &= (std::uint64_t{1} << span) - 1;
      word &= ~(bits << (slot % 64));
      for (; bits != 0; bits &= bits - 1) {
        const auto ahead = static_cast<unsigned>(__builtin_ctzll(bits));
        handler(base_ + ahead, ring_[slot + ahead]);
      }
      base_ += span;
    }
  }

 private:
  void grow() {
    std::vector<result> ring(ring_.size() * 2);
    std::vector<std::uint64_t> taken(ring.size() / 64);
    for (cycle c = base_; c < base_ + ring_.size(); ++c) {
      const std::size_t slot = c & (ring_.size() - 1);
      if ((taken_[slot / 64] >> (slot % 64) & 1) == 0) continue;
      const std::size_t to = c & (ring.size() - 1);
      ring[to] = ring_[slot];
      taken[to / 64] |= std::uint64_t{1} << (to % 64);
    }
    ring_ = std::move(ring);
    taken_ = std::move(taken);
  }

  cycle base_ = 0;
  std::vector<result> ring_ = std::vector<result>(4096);
  std::vector<std::uint64_t> taken_ = std::vector<std::uint64_t>(4096 / 64);
};

/// A core with its result buffer.
struct core_schedule {
  cycle free_from = 0;        ///< it takes a job from this cycle on; never while that is not known
  cycle drained = never;      ///< when the last result left the buffer
  // Where drains are followed in time: the result in the buffer or on its way there, and the one behind it.
  cycle buffered = never;     ///< when it came, or comes, to the buffer
  std::uint32_t job = 0;
  cycle done = never;         ///< a result waits for the buffer, or will, from this cycle on
  std::uint32_t next_job = 0;

  std::uint64_t jobs = 0, hits = 0, cost = 0, pushes = 0, depth = 0, ends = 0;
  std::uint64_t idle_cycles = 0;       ///< ready for a job
  std::uint64_t idle_selected = 0;     ///< and under the turning select
  std::uint64_t waited_cycles = 0;     ///< done, and the buffer full
  std::uint64_t full_cycles = 0;       ///< of the buffer
  std::uint64_t offered_cycles = 0;    ///< a job was shown to it
};

/// A replay that goes on as rays are walked.
class job_schedule {
 public:
  virtual ~job_schedule() = default;
  virtual void advance(std::size_t end) = 0;
  virtual run_figures finish(const numeric::float_to_fixed_stats& conversion) = 0;
};

/// One replay. `Held`: an offered result stays and the sink is not always ready.
template <bool Held>
class schedule final : public job_schedule {
 public:
  schedule(const design& d, const surroundings& s, const walked_rays& walked, const result_handler& handler)
      : design_(d),
        watchdog_(s.watchdog_cycles),
        policy_(d.scheduler_.select),
        walked_(walked),
        handler_(handler),
        cores_(d.rtu.cores),
        by_cores_(d.rtu.cores),
        offered_steps_(d.rtu.cores + 1),
        buses_(d.rtu.cores),
        core_params_(d.svo_core_params_with_format()),
        source_(s.source),
        accepted_(Held ? walked.size : 0) {
    if (s.sink.ready == sink_params::regime::lfsr) sink_.emplace(s.sink.seed);
    figures_.clock_mhz = d.rtu.clock_mhz;
    jobs_.jobs = walked_.size;
  }

  /// Follows the jobs before `end`, which are walked.
  void advance(std::size_t end) override {
    for (; next_job_ < end; ++next_job_) replay_job(next_job_);
  }
  run_figures finish(const numeric::float_to_fixed_stats& conversion) override {
    jobs_.conversion = conversion;
    figures_.add(jobs_);
    if constexpr (Held) follow_drains(never);
    order_.flush(last_result_ + 1, [this](cycle c, const leaving_order::result& r) { leave(c, r); });
    check_watchdog(last_dispatch_, last_result_);
    collect();
    return std::move(figures_);
  }

 private:
  using policy = scheduler_params::policy;

  void replay_job(std::uint32_t j) {
    const walked_ray& ray = walked_.rays[j];
    // The source offers, the stages move.
    cycle accepted = source_.next(source_.offered_from());
    for (cycle moves; (moves = stages_.next_move(accepted)) != accepted;) accepted = source_.next(moves);
    source_.accept(accepted);
    figures_.results.last_accepted = accepted;
    const cycle output_from = stages_.output_from(accepted);

    const cycle dispatched = dispatch(output_from);
    check_watchdog(last_dispatch_, dispatched);
    stages_.dispatch(output_from, dispatched);
    core_schedule& core = cores_[chosen_];
    account_dispatch(core, output_from, dispatched);
    last_dispatch_ = dispatched;
    if (ray.overflow)
      throw svo_stack_overflow(fmt::format("rtu.core_{}", chosen_), design_.svo_core.stack_depth, j, ray.job_word, dispatched);

    ++core.jobs;
    core.hits += ray.hit;
    core.cost += ray.cost;
    core.pushes += ray.pushes;
    core.depth += ray.depth;
    core.ends += !ray.hit && ray.cost > 2;
    auto& waits = figures_.results.waits;
    waits.dispatch_cycles += dispatched - accepted - stages;
    waits.traversal_cycles += ray.cost + std::uint64_t{1};

    const cycle done = dispatched + ray.cost + 1;
    if constexpr (Held) {
      accepted_[j] = accepted;
      core.free_from = never;
      if (core.buffered == never) {
        fill_buffer(core, done, j);
      } else {
        core.done = done;
        core.next_job = j;
      }
    } else {
      const cycle buffered = core.drained == never ? done : std::max(done, core.drained + 1);
      // The select meets the buffer every N cycles; in each such cycle it is offered.
      const cycle first = policy_ == policy::cyclic_first_available
                              ? dispatched + by_cores_.quotient(buffered - dispatched + cores_.size()) * cores_.size()
                              : next_turn(buffered + 1);
      cycle drained = first;
      std::uint64_t offers = 1;
      if (sink_) {
        for (; (sink_->state(drained) & 1) == 0; ++offers) {
          drained += cores_.size();
          if (offers > lfsr::period) throw too_far_apart();
        }
      }
      result_valid_cycles_ += offers;
      core.free_from = buffered + 1;
      core.drained = drained;
      core.waited_cycles += buffered - done;
      core.full_cycles += drained - buffered;
      last_result_ = std::max(last_result_, drained);
      order_.add(drained, {j, chosen_, drained - accepted});
    }
    if (order_.span(dispatched) >= leaving_order::batch)
      order_.flush(dispatched, [this](cycle c, const leaving_order::result& r) { leave(c, r); });
  }

  /// The first cycle >= c in which the select points at the chosen core.
  cycle next_turn(cycle c) const {
    const unsigned now = by_cores_.remainder(c);
    return c + (chosen_ >= now ? chosen_ - now : chosen_ + cores_.size() - now);
  }

  /// The cycle >= c in which the policy finds a core; that is then `chosen_`.
  cycle dispatch(cycle c) {
    const auto cores = static_cast<unsigned>(cores_.size());
    switch (policy_) {
      case policy::cyclic_first_available: {
        const std::uint64_t turned = select_ + (c - select_cycle_);
        unsigned at = turned < cores ? static_cast<unsigned>(turned) : by_cores_.remainder(turned);
        for (;; ++c, at = at + 1 < cores ? at + 1 : 0) {
          know(c);
          if (cores_[at].free_from <= c) break;
        }
        chosen_ = select_ = at;
        select_cycle_ = c;
        return c;
      }
      case policy::round_robin:
        chosen_ = in_line_;
        in_line_ = in_line_ + 1 < cores ? in_line_ + 1 : 0;
        if constexpr (Held)
          for (know(c); cores_[chosen_].free_from > c; know(c)) ++c;
        return std::max(c, cores_[chosen_].free_from);
      case policy::first_available: break;
    }
    for (know(c);; know(++c)) {
      for (chosen_ = 0; chosen_ < cores; ++chosen_)
        if (cores_[chosen_].free_from <= c) return c;
      if constexpr (!Held) c = std::max(c, earliest_free() - 1);
    }
  }

  cycle earliest_free() const {
    cycle least = never;
    for (const auto& core : cores_) least = std::min(least, core.free_from);
    return least;
  }

  /// Sees to it that all drains before cycle c are known.
  void know(cycle c) {
    if constexpr (Held) {
      if (c > 0) follow_drains(c - 1);
    }
  }

  void fill_buffer(core_schedule& core, cycle buffered, std::uint32_t job) {
    core.buffered = buffered;
    core.job = job;
    core.done = never;
    core.free_from = buffered + 1;
    ++outstanding_;
  }

  /// Follows the select as far as cycle `end` and notes what drains.
  void follow_drains(cycle end) {
    while (turn_cycle_ <= end) {
      if (outstanding_ == 0) {
        if (end == never) return;
        turn_ = by_cores_.remainder(turn_ + (end + 1 - turn_cycle_));
        turn_cycle_ = end + 1;
        return;
      }
      core_schedule& core = cores_[turn_];
      cycle drained = turn_cycle_;
      if (core.buffered != never && core.buffered < turn_cycle_) {
        drained = sink_->next(turn_cycle_);
        if (drained > end) return;  // offered, and taken later
        result_valid_cycles_ += drained - turn_cycle_ + 1;
        core.full_cycles += drained - core.buffered;
        last_result_ = std::max(last_result_, drained);
        order_.add(drained, {core.job, turn_, drained - accepted_[core.job]});
        --outstanding_;
        if (core.done != never) {
          const cycle buffered = std::max(core.done, drained + 1);
          core.waited_cycles += buffered - core.done;
          fill_buffer(core, buffered, core.next_job);
        } else {
          core.buffered = never;
        }
      }
      turn_cycle_ = drained + 1;
      turn_ = turn_ + 1 < cores_.size() ? turn_ + 1 : 0;
    }
  }

  void account_dispatch(core_schedule& core, cycle output_from, cycle dispatched) {
    const cycle idle = dispatched - core.free_from;  // cycles in which the core was ready before this one
    core.idle_cycles += idle + 1;
    pending_valid_cycles_ += dispatched - output_from + 1;
    const cycle behind = last_dispatch_ == never ? 0 : last_dispatch_ + 1;
    switch (policy_) {
      case policy::cyclic_first_available:
        core.idle_selected += by_cores_.quotient(idle) + 1;
        if (dispatched == output_from)
          ++core.offered_cycles;
        else
          offer_in_turn(output_from, dispatched);
        break;
      case policy::round_robin:
        core.offered_cycles += dispatched - output_from + 1;
        ready_cycles_ += dispatched - std::max(behind, core.free_from) + 1;
        break;
      case policy::first_available:
        ++core.offered_cycles;
        ready_cycles_ += dispatched - std::max(behind, earliest_free()) + 1;
        break;
    }
  }

  /// A job is shown to one core after the other in the cycles [from, to].
  void offer_in_turn(cycle from, cycle to) {
    const auto cores = static_cast<unsigned>(cores_.size());
    const cycle length = to - from + 1;
    offered_turns_ += by_cores_.quotient(length);
    const unsigned rest = by_cores_.remainder(length);
    if (rest == 0) return;
    const unsigned first = chosen_ + 1 >= rest ? chosen_ + 1 - rest : chosen_ + 1 + cores - rest;
    ++offered_steps_[first];
    --offered_steps_[chosen_ + 1];
    if (first > chosen_) ++offered_steps_[0], --offered_steps_[cores];
  }

  void leave(cycle c, const leaving_order::result& r) {
    const walked_ray& ray = walked_.rays[r.job];
    traversal_result t;
    t.job_word = ray.job_word;
    t.cost = ray.cost;
    t.hit = ray.hit;
    t.t_hit = ray.t_hit;
    t.core = static_cast<std::uint16_t>(r.core);
    t.sequence = r.job;
    figures_.results.count(c, t, r.latency_cycles);
    if (!handler_) return;
    // What the bus carries: a miss may keep the core's last hit.
    svo_outcome o;
    o.hit = ray.hit;
    o.t_hit = ray.t_hit;
    o.axis = ray.axis;
    auto& bus = buses_[r.core];
    bus.take(o, ray.job_word >> job_id_bits & 7, core_params_);
    t.t_hit = bus.t_hit;
    t.normal_axis = bus.axis;
    t.normal_sign = bus.sign;
    handler_(c, t, r.latency_cycles);
  }

  input_error too_far_apart() const {
    return input_error("--pace replay", fmt::format("transfers more than watchdog.cycles = {} apart", watchdog_),
                       "--pace skipping for such a run");
  }
  void check_watchdog(cycle from, cycle to) const {
    if (to - (from == never ? 0 : from) > watchdog_) throw too_far_apart();
  }

  /// The figures that follow from the sums.
  void collect() {
    const cycle end = last_result_ + 1;
    const std::uint64_t jobs = walked_.size;
    auto& waits = figures_.results.waits;
    waits.conversion_cycles = jobs * stages;
    for (const auto& core : cores_) {
      waits.buffer_cycles += core.waited_cycles;
      waits.result_cycles += core.full_cycles;
    }
    // Behind the last dispatch.
    switch (policy_) {
      case policy::cyclic_first_available:
        for (unsigned i = 0; i < cores_.size(); ++i) {
          chosen_ = i;
          const cycle turn = next_turn(cores_[i].free_from);
          ready_cycles_ += cores_[i].idle_selected + (turn < end ? by_cores_.quotient(end - 1 - turn) + 1 : 0);
        }
        break;
      case policy::round_robin: ready_cycles_ += cycles_from(cores_[in_line_].free_from, last_dispatch_ + 1, end); break;
      case policy::first_available: ready_cycles_ += cycles_from(earliest_free(), last_dispatch_ + 1, end); break;
    }
    const auto channel = [&](std::string name, std::uint64_t transfers, std::uint64_t valid, std::uint64_t ready) {
      figures_.channels.emplace_back(std::move(name),
                                     channel_stats{transfers, ready - transfers, valid - transfers, end + transfers - valid - ready});
    };
    channel("pending_job", jobs, pending_valid_cycles_, ready_cycles_);
    std::int64_t steps = 0;
    for (unsigned i = 0; i < cores_.size(); ++i) {
      core_schedule& core = cores_[i];
      core.idle_cycles += cycles_from(core.free_from, 0, end);
      steps += offered_steps_[i];
      channel(fmt::format("core_job_{}", i), core.jobs, core.offered_cycles + offered_turns_ + static_cast<std::uint64_t>(steps),
              core.idle_cycles);
    }
    for (unsigned i = 0; i < cores_.size(); ++i)
      channel(fmt::format("core_result_{}", i), cores_[i].jobs, cores_[i].jobs + cores_[i].waited_cycles, end - cores_[i].full_cycles);
    channel("job", jobs, source_.valid_cycles(), end - stages_.stalled());
    channel("result", jobs, result_valid_cycles_, sink_ ? sink_->count(0, end) : end);

    for (const auto& core : cores_) {
      svo_core::stats s;
      s.jobs = core.jobs;
      s.hits = core.hits;
      s.cost = core.cost;
      s.idle_cycles = core.idle_cycles;
      s.out_cycles = core.jobs + core.waited_cycles;
      s.visits = visits_of_sums(core.jobs, core.cost, core.pushes, core.depth, core.ends);
      figures_.add(s);
    }
  }

  const design& design_;
  cycle watchdog_;
  policy policy_;
  const walked_rays& walked_;
  const result_handler& handler_;
  job_manager::stats jobs_;
  std::vector<core_schedule> cores_;
  divider by_cores_;
  std::vector<std::int64_t> offered_steps_;  // as the scheduler's: whole turns, and what goes beyond them
  std::uint64_t offered_turns_ = 0;
  std::vector<svo_result_registers> buses_;
  svo_core_params core_params_;
  source_schedule source_;
  std::optional<lfsr> sink_;
  stages_schedule stages_;
  leaving_order order_;
  run_figures figures_;

  std::uint32_t next_job_ = 0;
  unsigned chosen_ = 0;
  unsigned select_ = 0;              // cyclic: the select in `select_cycle_`
  cycle select_cycle_ = 0;
  unsigned in_line_ = 0;             // round robin
  cycle last_dispatch_ = never;
  cycle last_result_ = 0;
  std::uint64_t pending_valid_cycles_ = 0;
  std::uint64_t ready_cycles_ = 0;   // of the scheduler
  std::uint64_t result_valid_cycles_ = 0;
  // Where drains are followed in time.
  unsigned turn_ = 0;                // the select in `turn_cycle_`
  cycle turn_cycle_ = 0;
  std::uint64_t outstanding_ = 0;    // results in buffers or on their way there
  std::vector<cycle> accepted_;
};

/// Walks jobs part by part, on any number of threads.
class walk_in_parts {
 public:
  walk_in_parts(const design& d, const std::vector<std::uint32_t>& image, const std::vector<job_packet>& jobs, walked_rays& all)
      : walk_(d.svo_core_params_with_format()),
        converter_(d.fixed_point, d.float_to_fixed),
        words_(view_of(image, d.memory_)),
        jobs_(jobs),
        all_(all),
        done_((jobs.size() + part - 1) / part) {}

  /// Walks the next part that nobody has begun; false when there is none.
  bool walk_part() {
    const std::size_t n = next_.fetch_add(1, std::memory_order_relaxed);
    if (n >= done_.size()) return false;
    numeric::float_to_fixed_stats conversion;
    traversal_job job;
    for (std::size_t j = n * part; j < std::min((n + 1) * part, jobs_.size()); ++j) {
      convert(jobs_[j], converter_, conversion, job);
      const svo_outcome o = walk_(job, words_);
      all_.rays[j] = {o.t_hit, o.job_word, o.cost, o.pushes, o.depth, o.axis, o.hit, o.overflow};
    }
    {
      const std::lock_guard lock(sums_);
      all_.conversion += conversion;
    }
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

  svo_walk walk_;
  numeric::float_to_fixed_converter converter_;
  word_view words_;
  const std::vector<job_packet>& jobs_;
  walked_rays& all_;
  std::mutex sums_;
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
  void start(std::function<void()> work, std::function<void()> stop) {
    stops_.push_back(std::move(stop));
    threads_.emplace_back(std::move(work));
  }
  void join() {
    for (auto& t : threads_) t.join();
    threads_.clear();
  }

 private:
  std::vector<std::function<void()>> stops_;
  std::vector<std::thread> threads_;
};

std::unique_ptr<job_schedule> schedule_for(const design& d, const surroundings& s, const walked_rays& walked,
                                           const result_handler& handler) {
  if (const std::string why = replay_obstacle(d, s); !why.empty())
    throw input_error("--pace replay", why, "a design whose schedule follows from the costs of its rays; --pace skipping takes every one");
  const bool always = s.sink.ready == sink_params::regime::always;
  if (d.result_manager_.valid_withdrawn || always) return std::make_unique<schedule<false>>(d, s, walked, handler);
  return std::make_unique<schedule<true>>(d, s, walked, handler);
}

}  // namespace

std::string replay_obstacle(const design& d, const surroundings& s) {
  if (d.rtu.core != rtu_params::core_kind::svo) return "triangle cores, in which rays overlap";
  if (d.memory_.which != memory::kind::lut) return "a memory that makes cores wait";
  if (s.sink.ready == sink_params::regime::blocked) return "sink.ready = never";
  return {};
}

walked_rays walk_rays(const design& d, const std::vector<std::uint32_t>& image, const std::vector<job_packet>& jobs, unsigned threads) {
  walked_rays all(jobs.size());
  walk_in_parts walks(d, image, jobs, all);
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

run_figures replay(const design& d, const surroundings& s, const std::vector<std::uint32_t>& image, const std::vector<job_packet>& jobs,
                   unsigned threads, const result_handler& handler) {
  walked_rays walked(jobs.size());
  const auto schedule = schedule_for(d, s, walked, handler);
  walk_in_parts walks(d, image, jobs, walked);
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
