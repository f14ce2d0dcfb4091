// Buffers that fill and drain, at the same edge too, against registers followed cycle by cycle.

#include "modules/result_manager/result_manager.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/formats/packets.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/in_child.h"

namespace rtusim {
namespace {

/// How cores offer and the sink takes.
struct ends {
  std::vector<source_params> cores;
  sink_params sink;
  unsigned results = 3;  // of each core
};

struct observer {
  std::vector<std::string>* log;
  void transferred(unsigned which, cycle c, const voxel_result& r) {
    auto& lines = *log;
    if (c >= lines.size()) lines.resize(c + 1);
    // Of one cycle in the order of the cores, the output last.
    lines[c] += fmt::format("{}{}:{} ", which < 1000 ? "in" : "out", which < 1000 ? which : 0u, r.sequence);
  }
};

std::string text_of(const std::vector<std::string>& log) {
  std::string text;
  for (std::size_t c = 0; c < log.size(); ++c) {
    std::string line = log[c];
    if (line.empty()) continue;
    std::vector<std::string> words;
    for (std::size_t at = 0, end; (end = line.find(' ', at)) != std::string::npos; at = end + 1) words.push_back(line.substr(at, end - at));
    std::sort(words.begin(), words.end());
    text += fmt::format("{}", c);
    for (const auto& w : words) text += ' ' + w;
    text += '\n';
  }
  return text;
}

/// Core i's result k has the sequence 100 i + k.
std::vector<std::vector<voxel_result>> results_of(const ends& e) {
  std::vector<std::vector<voxel_result>> all(e.cores.size());
  for (std::uint32_t i = 0; i < all.size(); ++i)
    for (std::uint32_t k = 0; k < e.results; ++k) {
      voxel_result r;
      r.sequence = 100 * i + k;
      all[i].push_back(r);
    }
  return all;
}

std::string simulated(const ends& e, bool valid_withdrawn, pace p) {
  return in_child([&] {
    clock_domain clock("clock_domain", 100);
    const auto items = results_of(e);
    const auto count = static_cast<unsigned>(items.size());
    std::vector<std::unique_ptr<stream_source<voxel_result>>> sources;
    std::vector<std::unique_ptr<channel<voxel_result>>> inputs;
    for (unsigned i = 0; i < count; ++i) {
      sources.push_back(std::make_unique<stream_source<voxel_result>>(fmt::format("source_{}", i).c_str(), e.cores[i], items[i]));
      inputs.push_back(std::make_unique<channel<voxel_result>>(fmt::format("input_{}", i).c_str()));
    }
    result_manager_params params;
    params.valid_withdrawn = valid_withdrawn;
    result_manager<voxel_result> manager("result_manager", params, count);
    stream_sink<voxel_result> sink("sink", e.sink, std::uint64_t{count} * e.results);
    channel<voxel_result> output("output");
    std::vector<std::string> log;
    observer seen{&log};
    for (unsigned i = 0; i < count; ++i) {
      sources[i]->out(*inputs[i]);
      manager.core_in[i](*inputs[i]);
      inputs[i]->observe(seen, i);
    }
    manager.result_out(output);
    sink.in(output);
    output.observe(seen, 1000);
    clock.set_pace(p);
    clock.start();
    return text_of(log);
  });
}

std::uint32_t stepped(std::uint32_t x) { return x % 2 != 0 ? x / 2 ^ 0xB400 : x / 2; }

/// What the cores, the buffers and the select do, as their registers are described.
std::string expected(const ends& e, bool valid_withdrawn) {
  struct core {
    std::size_t sent = 0;
    cycle from = 0;
    std::uint32_t random = 0;
    bool full = false;
    std::uint32_t buffer = 0;
  };
  const auto items = results_of(e);
  const std::size_t count = items.size();
  std::vector<core> cores(count);
  for (std::size_t i = 0; i < count; ++i) cores[i].random = e.cores[i].seed;
  std::uint32_t sink = e.sink.seed;
  std::size_t select = 0;
  std::uint64_t received = 0;
  std::vector<std::string> log;
  for (cycle c = 0; received < std::uint64_t{count} * e.results; ++c) {
    std::string& line = log.emplace_back();
    const bool offered = cores[select].full;
    const bool taken = offered && (e.sink.ready == sink_params::regime::always || sink % 2 != 0);
    std::vector<std::size_t> filled;
    for (std::size_t i = 0; i < count; ++i) {
      const core& k = cores[i];
      const bool is_random = e.cores[i].valid == source_params::regime::lfsr;
      if (!k.full && k.sent < items[i].size() && c >= k.from && (!is_random || k.random % 2 != 0)) filled.push_back(i);
    }
    if (taken) {
      line += fmt::format("out0:{} ", cores[select].buffer);
      cores[select].full = false;
      ++received;
    }
    for (const std::size_t i : filled) {
      core& k = cores[i];
      k.full = true;
      k.buffer = items[i][k.sent++].sequence;
      k.from = c + 1 + (e.cores[i].valid == source_params::regime::gap ? e.cores[i].gap_cycles : 0);
      line += fmt::format("in{}:{} ", i, k.buffer);
    }
    if (valid_withdrawn || !offered || taken) select = (select + 1) % count;
    for (core& k : cores) k.random = stepped(k.random);
    sink = stepped(sink);
  }
  return text_of(log);
}

constexpr pace paces[] = {pace::skipping, pace::stepped, pace::checked};

}  // namespace

TEST_CASE("result_manager: a buffer is empty from the edge after its transfer on", "[result_manager]") {
  for (const pace p : paces)
    for (const bool withdrawn : {false, true}) {
      CAPTURE(static_cast<int>(p), withdrawn);
      ends one;
      one.cores.resize(1);
      CHECK(simulated(one, withdrawn, p) == "0 in0:0\n1 out0:0\n2 in0:1\n3 out0:1\n4 in0:2\n5 out0:2\n");
      // Of two one drains at the edge at which the other fills.
      ends two;
      two.cores.resize(2);
      two.results = 2;
      CHECK(simulated(two, withdrawn, p) == "0 in0:0 in1:100\n1 out0:100\n2 in1:101 out0:0\n3 in0:1 out0:101\n4 out0:1\n");
      // Three, as the select passes: full all at once, empty one by one.
      ends three;
      three.cores.resize(3);
      three.results = 1;
      CHECK(simulated(three, withdrawn, p) == "0 in0:0 in1:100 in2:200\n1 out0:100\n2 out0:200\n3 out0:0\n");
    }
}

TEST_CASE("result_manager: the registers' transfers, whatever cores and sink do", "[result_manager]") {
  using source = source_params::regime;
  for (const unsigned count : {1u, 2u, 5u})
    for (const unsigned kind : {0u, 1u, 2u})
      for (const auto ready : {sink_params::regime::always, sink_params::regime::lfsr}) {
        ends e;
        e.results = 20;
        e.sink.ready = ready;
        for (unsigned i = 0; i < count; ++i) {
          source_params core;
          core.valid = kind == 0 ? source::always : kind == 1 ? source::lfsr : i % 2 == 0 ? source::lfsr : source::gap;
          core.gap_cycles = 1 + i % 4 * 2;
          core.seed = static_cast<std::uint16_t>(0xBEEF + 977 * i);
          e.cores.push_back(core);
        }
        for (const bool withdrawn : {false, true}) {
          const std::string wanted = expected(e, withdrawn);
          for (const pace p : {pace::skipping, pace::checked}) {
            CAPTURE(count, kind, static_cast<int>(ready), withdrawn, static_cast<int>(p));
            REQUIRE(simulated(e, withdrawn, p) == wanted);
          }
        }
      }
}

}  // namespace rtusim
