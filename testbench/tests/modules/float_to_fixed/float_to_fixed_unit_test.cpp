#include "modules/float_to_fixed/float_to_fixed.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "testbench/tests/pipeline_run.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

std::string text(std::int64_t word) { return std::to_string(word); }

std::string log_of(const float_to_fixed::params& p, const std::vector<std::uint32_t>& words, const test::pipeline_run& run) {
  return test::pipeline_log<float_to_fixed, std::uint32_t, std::int64_t>(p, words, run, text);
}

}  // namespace

TEST_CASE("float_to_fixed: a word in every cycle, five cycles later", "[float_to_fixed]") {
  // 1, -0.5 and 2^-17, which has no bit of its own in 16.16.
  const std::vector<std::uint32_t> words{0x3f800000, 0xbf000000, 0x37000000};
  CHECK(log_of({}, words, {}) == "0 in \n1 in \n2 in \n5 out 65536\n6 out -32768\n7 out 0\n");
}

TEST_CASE("float_to_fixed: the plain function's words in any format, whatever stalls, in every pace", "[float_to_fixed]") {
  test::rng random(23);
  for (int round = 0; round < 4; ++round) {
    float_to_fixed::params p;
    p.format.integer_bits = 2 + random() % 31;
    p.format.fraction_bits = 1 + random() % 32;
    p.conversion = {random() % 2 == 0, random() % 2 == 0, random() % 2 == 0};
    const numeric::float_to_fixed_converter convert(p.format, p.conversion);
    std::vector<std::uint32_t> words(200);
    std::string wanted;
    numeric::float_to_fixed_stats ignored;
    for (std::uint32_t& word : words) {
      word = random();
      wanted += text(convert(word, ignored)) + '\n';
    }
    for (const auto& paces : test::stalled_runs(random() % 1000 + 1)) {
      CAPTURE(round, p.format.integer_bits, p.format.fraction_bits);
      const std::string log = log_of(p, words, paces[0]);
      REQUIRE(test::payloads(log) == wanted);
      for (const auto& run : paces) REQUIRE(log_of(p, words, run) == log);
    }
  }
}

TEST_CASE("float_to_fixed: conversions and what does not fit are counted", "[float_to_fixed]") {
  clock_domain clock("clock_domain", 100);
  // 1, infinity, no number, 2^20, -0
  const std::vector<std::uint32_t> words{0x3f800000, 0x7f800000, 0x7fc00000, 0x49800000, 0x80000000};
  stream_source<std::uint32_t> source("source", {}, words);
  stream_sink<std::int64_t> sink("sink", {}, words.size());
  float_to_fixed unit("float_to_fixed", {});
  channel<std::uint32_t> in("in");
  channel<std::int64_t> out("out");
  source.out(in);
  unit.in(in);
  unit.out(out);
  sink.in(out);
  clock.start();
  CHECK(unit.statistics().conversions == 5);
  CHECK(unit.statistics().overflows == 2);
  CHECK(unit.statistics().nans == 1);
}

}  // namespace rtusim
