#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "modules/timing/clock_domain.h"
#include "modules/timing/link.h"
#include "modules/timing/waveform.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

using word = std::uint32_t;

/// Asks for a word, waits for it, and asks for the next.
class requester final : public unit {
 public:
  rv_out<word> request{"request"};
  rv_in<word> response{"response"};

  explicit requester(const sc_core::sc_module_name& name, std::uint64_t& left) : unit(name), left_(left) {}

  void leaves(channel_base&) override { response->offer_ready(offer::always_from(now() + 1)); }
  void arrives(channel_base&) override {
    address_ = response->data() + 1;
    if (--left_ == 0) domain().stop();
    request->offer_valid(offer::always_from(now() + 1));
  }

 private:
  void reset() override {
    request->drive(address_);
    request->offer_valid(offer::always_from(0));
  }
  bool level(const channel_base&) const override { return false; }
  void trace(waveform&) const override {}

  std::uint64_t& left_;
  word address_ = 0;
};

/// Answers after a while, one request after the other.
class store final : public unit {
 public:
  rv_in<word> request{"request"};
  rv_out<word> response{"response"};

  store(const sc_core::sc_module_name& name, cycle latency) : unit(name), latency_(latency) {}

  void arrives(channel_base&) override {
    word_ = request->data();
    response->offer_valid(offer::always_from(now() + latency_));
  }
  void leaves(channel_base&) override { request->offer_ready(offer::always_from(now() + 1)); }

 private:
  void reset() override {
    response->drive(word_);
    request->offer_ready(offer::always_from(0));
  }
  bool level(const channel_base&) const override { return false; }
  void trace(waveform&) const override {}

  cycle latency_;
  word word_ = 0;
};

/// A request and its answer through two links, each requester at a store of its own, whose latencies differ.
void round_trip(benchmark::State& state) {
  constexpr std::uint64_t trips = 1'000'000;
  const auto requesters = static_cast<unsigned>(state.range(0));
  for (auto _ : state) {
    const std::string answer = in_child([&] {
      clock_domain clock("clock_domain", 100);
      std::uint64_t left = trips;
      sc_core::sc_vector<requester> asking("requester", requesters, [&](const char* n, std::size_t) { return new requester(n, left); });
      sc_core::sc_vector<store> stores("store", requesters, [](const char* n, std::size_t i) { return new store(n, 10 + i % 7); });
      sc_core::sc_vector<link<word, requester, store>> requests("request", requesters);
      sc_core::sc_vector<link<word, store, requester>> responses("response", requesters);
      for (unsigned i = 0; i < requesters; ++i) {
        asking[i].request(requests[i]);
        stores[i].request(requests[i]);
        stores[i].response(responses[i]);
        asking[i].response(responses[i]);
      }
      const auto begin = std::chrono::steady_clock::now();
      clock.start();
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      return fmt::format("{}", spent.count());
    });
    double spent = 0;
    if (std::sscanf(answer.c_str(), "%lf", &spent) != 1) return state.SkipWithError(answer.c_str());
    state.SetIterationTime(spent);
  }
  state.counters["ns_per_trip"] =
      benchmark::Counter(static_cast<double>(trips) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(round_trip)->Name("kernel/request_and_answer/requesters")->Arg(1)->Arg(16)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rtusim
