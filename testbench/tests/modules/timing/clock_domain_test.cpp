#include "modules/timing/clock_domain.h"

#include <catch2/catch.hpp>

#include <string>

#include "modules/config/error.h"
#include "modules/timing/channel.h"
#include "modules/timing/waveform.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

/// Makes a token every `interval` edges, whatever transfers, as a timer does; holds one at most and counts those it had to drop.
class timer final : public unit {
 public:
  rv_out<std::uint32_t> out{"out"};

  timer(const sc_core::sc_module_name& name, cycle interval) : unit(name), interval_(interval) {}

  std::uint64_t dropped = 0;

  void leaves(channel_base&) override { full_ = false; }
  void booked_edge() override {
    dropped += full_;
    ++token_;
    full_ = true;
    out->offer_valid(offer::always_from(now() + 1));
    book_edge(now() + interval_);
  }

 private:
  void reset() override {
    out->drive(token_);
    out->offer_valid(offer::none());
    book_edge(interval_ - 1);
  }
  bool level(const channel_base&) const override { return full_; }
  void trace(waveform& w) const override { w.add(token_, std::string(name()) + ".token"); }

  cycle interval_;
  std::uint32_t token_ = 0;
  bool full_ = false;
};

struct recorder {
  std::string text;
  void transferred(unsigned, cycle c, const std::uint32_t& token) { text += fmt::format("{}@{} ", token, c); }
};

std::string run_timer(pace p, sink_params::regime ready) {
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    sink_params sink_p;
    sink_p.ready = ready;
    timer t("timer", 7);
    stream_sink<std::uint32_t> sink("sink", sink_p, 200);
    channel<std::uint32_t> tokens("tokens");
    recorder seen;
    t.out(tokens);
    sink.in(tokens);
    tokens.observe(seen, 0);
    clock.set_pace(p);
    clock.set_watchdog(1'000);
    clock.start();
    return fmt::format("{}dropped {} of {}", seen.text, t.dropped, clock.next_edge());
  });
}

}  // namespace

TEST_CASE("clock_domain: a unit that books its own edges, in every pace", "[timing]") {
  const std::string always = run_timer(pace::skipping, sink_params::regime::always);
  CHECK_THAT(always, Catch::StartsWith("1@7 2@14 3@21 "));
  CHECK_THAT(always, Catch::EndsWith("200@1400 dropped 0 of 1401"));
  CHECK(always == run_timer(pace::stepped, sink_params::regime::always));
  CHECK(always == run_timer(pace::checked, sink_params::regime::always));
  const std::string random = run_timer(pace::skipping, sink_params::regime::lfsr);
  CHECK(random == run_timer(pace::stepped, sink_params::regime::lfsr));
  CHECK(random == run_timer(pace::checked, sink_params::regime::lfsr));
}

TEST_CASE("clock_domain: a design that is not whole is refused", "[timing]") {
  const std::string without_consumer = in_child([] {
    clock_domain clock("clock_domain", 100);
    timer t("timer", 7);
    channel<std::uint32_t> tokens("tokens");
    t.out(tokens);
    clock.start();
    return std::string("ran");
  });
  CHECK(without_consumer == "error: channel tokens has no consumer");
}

}  // namespace rtusim
