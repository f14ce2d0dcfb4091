// Pipelines of any depth against registers in a row, moved cycle by cycle.

#include "modules/timing/pipeline_unit.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "testbench/tests/pipeline_run.h"

namespace rtusim {
namespace {

/// Gives what enters, and 1000.
class delay final : public pipeline_unit<std::uint32_t, std::uint32_t> {
 public:
  struct params {
    unsigned stages = 1, interval = 1;
  };
  delay(const sc_core::sc_module_name& name, const params& p) : pipeline_unit(name, p.stages, p.interval) {}

 private:
  void process(const std::uint32_t& number, std::uint32_t& result) override { result = number + 1000; }
};

std::string log_of(const delay::params& p, const std::vector<std::uint32_t>& items, const test::pipeline_run& run) {
  return test::pipeline_log<delay, std::uint32_t, std::uint32_t>(p, items, run, [](std::uint32_t v) { return std::to_string(v); });
}

std::vector<std::uint32_t> numbers(std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = i;
  return all;
}

/// A shift register's bit 0 (see `lfsr`), from the usual seeds.
struct random_bits {
  std::uint32_t x;
  void step() { x = x % 2 != 0 ? x / 2 ^ 0xB400 : x / 2; }
  bool bit() const { return x % 2 != 0; }
};

/// The same log, from registers in a row with one enable.
std::string expected(const delay::params& p, const std::vector<std::uint32_t>& items, const test::pipeline_run& run) {
  std::string in, out;
  std::vector<std::optional<std::uint32_t>> row(p.stages);
  random_bits source{0xBEEF}, sink{0xACE1};
  std::size_t sent = 0, received = 0;
  unsigned until_offer = 0;           // of a source with gaps
  unsigned since_entry = p.interval;  // moves
  for (unsigned c = 0; received < items.size(); ++c, source.step(), sink.step()) {
    const bool has = sent < items.size();
    const bool offered =
        has && (run.source == source_params::regime::always || (run.source == source_params::regime::lfsr && source.bit()) ||
                (run.source == source_params::regime::gap && until_offer == 0));
    const bool wanted = run.sink == sink_params::regime::always || sink.bit();
    const bool leaves = row.back() && wanted;
    const bool moves = leaves || !row.back();
    const bool enters = offered && moves && since_entry >= p.interval;
    if (leaves) {
      out += fmt::format("{} out {}\n", c, *row.back());
      ++received;
    }
    if (until_offer > 0) --until_offer;
    if (moves) {
      std::move_backward(row.begin(), row.end() - 1, row.end());
      row.front().reset();
      ++since_entry;
    }
    if (enters) {
      in += fmt::format("{} in \n", c);
      row.front() = items[sent++] + 1000;
      since_entry = 1;
      until_offer = 1;
    }
  }
  return in + out;
}

}  // namespace

TEST_CASE("pipeline_unit: one stage, and 64", "[timing]") {
  const auto three = numbers(3);
  const test::pipeline_run ideal;
  CHECK(log_of({1, 1}, three, ideal) == "0 in \n1 in \n2 in \n1 out 1000\n2 out 1001\n3 out 1002\n");
  CHECK(log_of({2, 1}, three, ideal) == "0 in \n1 in \n2 in \n2 out 1000\n3 out 1001\n4 out 1002\n");
  CHECK(log_of({2, 2}, three, ideal) == "0 in \n2 in \n4 in \n2 out 1000\n4 out 1001\n6 out 1002\n");
  CHECK(log_of({64, 1}, three, ideal) == "0 in \n1 in \n2 in \n64 out 1000\n65 out 1001\n66 out 1002\n");
  CHECK(log_of({64, 64}, three, ideal) == "0 in \n64 in \n128 in \n64 out 1000\n128 out 1001\n192 out 1002\n");
  CHECK(log_of({64, 63}, three, ideal) == "0 in \n63 in \n126 in \n64 out 1000\n127 out 1001\n190 out 1002\n");
  test::pipeline_run gaps;
  gaps.source = source_params::regime::gap;
  CHECK(log_of({1, 1}, three, gaps) == "0 in \n2 in \n4 in \n1 out 1000\n3 out 1001\n5 out 1002\n");
}

TEST_CASE("pipeline_unit: registers in a row with one enable, whatever stalls, in every pace", "[timing]") {
  const auto items = numbers(120);
  for (const delay::params& p : {delay::params{1, 1}, {2, 1}, {2, 2}, {5, 3}, {63, 1}, {64, 1}, {64, 64}, {65, 1}, {65, 64}})
    for (const auto& paces : test::stalled_runs(p.stages)) {
      CAPTURE(p.stages, p.interval, static_cast<int>(paces[0].source), static_cast<int>(paces[0].sink));
      const std::string wanted = expected(p, items, paces[0]);
      for (const auto& run : paces) REQUIRE(log_of(p, items, run) == wanted);
    }
}

}  // namespace rtusim
