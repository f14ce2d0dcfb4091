// What happens at an edge depends on the registers before it, whichever call comes first: offers that are revised at the edge at which they
// are taken.

#include <catch2/catch.hpp>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/scheduler/scheduler.h"
#include "modules/timing/channel.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/link.h"
#include "modules/timing/pipeline_unit.h"
#include "modules/timing/waveform.h"
#include "testbench/bench/lfsr.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

using word = std::uint32_t;

/// What an arrival does to the offer of the next number.
enum class mood : std::uint8_t {
  fickle,  ///< it is made or taken back, by turns, and made again after each number
  lavish,  ///< it is made, and ends with the number, if nothing arrives with that
};

/// Takes all that comes, and offers numbers by its mood.
class moody final : public unit {
 public:
  rv_in<word> in{"in"};
  rv_out<word> out{"out"};

  moody(const sc_core::sc_module_name& name, mood m) : unit(name), mood_(m) {}

  void arrives(channel_base&) override {
    gives_ = mood_ == mood::lavish || !gives_;
    arrived_ = now();
    in->offer_ready(offer::always_from(now() + 1));
    out->offer_valid(gives_ ? offer::always_from(now() + 1) : offer::none());
  }
  void leaves(channel_base&) override {
    number_ += 1;
    if (mood_ == mood::lavish)
      gives_ = arrived_ == now();  // and has offered it
    else if (gives_)
      out->offer_valid(offer::always_from(now() + 1));
  }

 private:
  void reset() override {
    out->drive(number_);
    in->offer_ready(offer::always_from(0));
  }
  bool level(const channel_base& port) const override { return &port == in.operator->() || gives_; }
  void trace(waveform&) const override {}

  mood mood_;
  bool gives_ = false;
  cycle arrived_ = never;
  word number_ = 0;
};

class delay final : public pipeline_unit<word, word> {
 public:
  delay(const sc_core::sc_module_name& name, unsigned stages) : pipeline_unit(name, stages) {}

 private:
  void process(const word& number, word& result) override { result = number; }
};

struct recorder {
  std::string text;
  void transferred(unsigned, cycle c, const word& number) { text += fmt::format("{}@{} ", number, c); }
};

/// Gives each number after 1 to 4 cycles, and takes the next in the cycle after that has gone.
class echo final : public unit {
 public:
  rv_in<word> in{"in"};
  rv_out<word> out{"out"};

  explicit echo(const sc_core::sc_module_name& name) : unit(name) {}

  void arrives(channel_base&) override {
    number_ = in->data();
    from_ = now() + 1 + number_ % 4;
    out->offer_valid(offer::always_from(from_));
  }
  void leaves(channel_base&) override {
    from_ = never;
    in->offer_ready(offer::always_from(now() + 1));
  }

 private:
  void reset() override {
    out->drive(number_);
    in->offer_ready(offer::always_from(0));
  }
  bool level(const channel_base& port) const override { return &port == in.operator->() ? from_ == never : from_ <= next_edge(); }
  void trace(waveform&) const override {}

  cycle from_ = never;
  word number_ = 0;
};

/// Which of several channels transferred when.
struct stopping_recorder {
  clock_domain& clock;
  std::size_t left;
  std::string text;
  void transferred(unsigned which, cycle c, const word& number) {
    text += fmt::format("{}:{}@{} ", which, number, c);
    if (--left == 0) clock.stop();
  }
};

constexpr std::size_t taken = 200;

/// source -> scheduler -> three echoes, each with a sink.
std::string scheduled(unsigned policy, pace p, std::uint32_t shuffle) {
  return in_child([&] {
    constexpr unsigned echoes = 3;
    clock_domain clock("clock_domain", 100);
    std::vector<word> items(1000);
    test::rng random(5);
    for (word& item : items) item = static_cast<word>(random());
    stream_source<word> source("source", {}, items);
    scheduler_params params;
    params.select = policy;
    scheduler<word> middle("scheduler", params, echoes);
    sc_core::sc_vector<echo> cores("echo", echoes);
    sc_core::sc_vector<stream_sink<word>> sinks("sink", echoes, [](const char* n, std::size_t i) {
      sink_params sink_p;
      if (i == 1) sink_p.ready = sink_params::regime::lfsr;
      return new stream_sink<word>(n, sink_p, never);
    });
    channel<word> job("job");
    sc_core::sc_vector<channel<word>> jobs("core_job", echoes), results("core_result", echoes);
    stopping_recorder seen{clock, taken, {}};
    source.out(job);
    middle.job_in(job);
    for (unsigned i = 0; i < echoes; ++i) {
      middle.core_out[i](jobs[i]);
      cores[i].in(jobs[i]);
      cores[i].out(results[i]);
      sinks[i].in(results[i]);
      jobs[i].observe(seen, i);
    }
    clock.set_pace(p);
    clock.shuffle_units(shuffle);
    clock.start();
    return seen.text;
  });
}

/// source -> moody -> pipeline, or not -> sink.
std::string simulated(mood m, unsigned stages, pace p, std::uint32_t shuffle) {
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    const std::vector<word> items(100'000);
    source_params source_p;
    source_p.valid = source_params::regime::lfsr;
    sink_params sink_p;
    sink_p.ready = sink_params::regime::lfsr;
    stream_source<word> source("source", source_p, items);
    moody middle("moody", m);
    stream_sink<word> sink("sink", sink_p, taken);
    std::unique_ptr<delay> behind;
    channel<word> job("job"), last("last");
    std::unique_ptr<link<word, moody, delay>> between;
    source.out(job);
    middle.in(job);
    if (stages == 0) {
      middle.out(last);
    } else {
      behind = std::make_unique<delay>("delay", stages);
      between = std::make_unique<link<word, moody, delay>>("between");
      middle.out(*between);
      behind->in(*between);
      behind->out(last);
    }
    sink.in(last);
    recorder given, got;
    if (between) between->observe(given, 0);
    last.observe(got, 0);
    clock.set_pace(p);
    clock.shuffle_units(shuffle);
    clock.start();
    const auto counts = [](channel_base& ch) {
      const channel_stats s = ch.stats();
      return fmt::format("{} {} {} {}; ", s.transferred, s.starved, s.back_pressured, s.idle);
    };
    return given.text + got.text + (between ? counts(*between) : "") + counts(last);
  });
}

/// The same, by registers that move cycle by cycle.
std::string expected(mood m, unsigned stages) {
  const lfsr source(source_params{}.seed), sink(sink_params{}.seed);
  std::string given, got;
  std::deque<std::pair<bool, word>> row(stages);
  bool gives = false;
  word number = 0;
  std::uint64_t counts[2][4] = {};
  const auto count = [&counts](unsigned which, bool valid, bool ready) { ++counts[which][valid ? (ready ? 0 : 2) : (ready ? 1 : 3)]; };
  std::size_t received = 0;
  for (cycle c = 0; received < taken; ++c) {
    const bool arrives = (source.state(c) & 1) != 0, wanted = (sink.state(c) & 1) != 0;
    const bool offered = stages == 0 ? gives : row.back().first;
    const word offered_number = stages == 0 ? number : row.back().second;
    const bool leaves = offered && wanted;
    const bool moves = stages != 0 && (leaves || !offered);
    const bool gone = gives && (stages == 0 ? leaves : moves);
    if (stages != 0) count(0, gives, moves);
    count(1, offered, wanted);
    if (leaves) {
      got += fmt::format("{}@{} ", offered_number, c);
      ++received;
    }
    if (gone && stages != 0) given += fmt::format("{}@{} ", number, c);
    if (moves) {
      row.pop_back();
      row.emplace_front(gone, number);
    }
    number += gone;
    gives = m == mood::fickle ? gives != arrives : arrives || (gives && !gone);
  }
  const auto text = [&counts](unsigned which) {
    const auto& n = counts[which];
    return fmt::format("{} {} {} {}; ", n[0], n[1], n[2], n[3]);
  };
  return given + got + (stages == 0 ? "" : text(0)) + text(1);
}

}  // namespace

TEST_CASE("edges: offers that are made and taken back as one is taken, in every pace and order of calls", "[timing]") {
  for (const mood m : {mood::fickle, mood::lavish})
    for (const unsigned stages : {0u, 1u, 2u, 5u}) {
      const std::string wanted = expected(m, stages);
      for (const pace p : {pace::skipping, pace::stepped, pace::checked})
        for (const std::uint32_t shuffle : {0u, 1u, 2u, 3u}) {
          CAPTURE(static_cast<int>(m), stages, static_cast<int>(p), shuffle);
          REQUIRE(simulated(m, stages, p, shuffle) == wanted);
        }
    }
}

TEST_CASE("edges: a job goes to a core that was ready before the edge, whatever leaves at it", "[timing]") {
  for (unsigned policy = 0; policy < scheduler_policies::count; ++policy) {
    const std::string plain = scheduled(policy, pace::checked, 0);
    REQUIRE(plain.find("error") == std::string::npos);
    for (const pace p : {pace::skipping, pace::stepped, pace::checked})
      for (std::uint32_t shuffle = 0; shuffle < 6; ++shuffle) {
        CAPTURE(policy, static_cast<int>(p), shuffle);
        REQUIRE(scheduled(policy, p, shuffle) == plain);
      }
  }
}

TEST_CASE("link: ends of other types are refused", "[timing]") {
  const std::string refused = in_child([] {
    clock_domain clock("clock_domain", 100);
    const std::vector<word> items(3);
    stream_source<word> source("source", {}, items);
    stream_sink<word> sink("sink", {}, items.size());
    link<word, moody, stream_sink<word>> between("between");
    source.out(between);
    sink.in(between);
    clock.start();
    return std::string("ran");
  });
  CHECK(refused == "error: link between has an end of another type");
}

}  // namespace rtusim
