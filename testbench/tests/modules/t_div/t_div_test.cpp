#include "modules/t_div/t_div.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "modules/numeric/fixed_point.h"
#include "testbench/tests/pipeline_run.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

using numeric::divider_kind;

std::string text(const quotient& q) { return fmt::format("{:x} {}", q.word, q.err); }

std::string log_of(const t_div::params& p, const std::vector<division>& divisions, const test::pipeline_run& run) {
  return test::pipeline_log<t_div, division, quotient>(p, divisions, run, [](const quotient& q) { return text(q); });
}

std::vector<division> random_divisions(test::rng& random, unsigned width, std::size_t count) {
  const auto word = [&] {
    const auto bits = static_cast<std::int64_t>(std::uint64_t{random()} << 32 | random());
    return numeric::wrap(bits, width) >> random() % width;
  };
  std::vector<division> all(count);
  for (division& d : all) {
    d.n = word();
    d.d = word();
  }
  return all;
}

}  // namespace

TEST_CASE("t_div: a quotient in every cycle, width clocks later, or one in width clocks", "[t_div]") {
  const std::vector<division> divisions{{1, 2}, {1, 4}, {-3, 4}};
  const test::pipeline_run ideal;
  CHECK(log_of({8, divider_kind::pipelined}, divisions, ideal) == "0 in \n1 in \n2 in \n8 out 20 false\n9 out 10 false\n10 out b0 true\n");
  CHECK(log_of({8, divider_kind::iterative}, divisions, ideal) ==
        "0 in \n8 in \n16 in \n8 out 20 false\n16 out 10 false\n24 out b0 true\n");
}

TEST_CASE("t_div: the plain function's words at any width, whatever stalls, in every pace", "[t_div]") {
  test::rng random(11);
  for (int design = 0; design < 8; ++design) {
    t_div::params p;
    p.width = design == 0 ? 4 : design == 1 ? 64 : 4 + random() % 61;
    p.kind = static_cast<divider_kind>(design % 2);
    const auto divisions = random_divisions(random, p.width, 300);
    const numeric::divider divide(p.width);
    std::string wanted;
    for (const division& d : divisions) {
      const numeric::quotient_bits q = divide(d.n, d.d);
      wanted += text({q.word(p.width), q.err}) + '\n';
    }
    for (const auto& paces : test::stalled_runs(random() % 1000 + 1)) {
      CAPTURE(p.width, design, static_cast<int>(paces[0].source), static_cast<int>(paces[0].sink));
      const std::string log = log_of(p, divisions, paces[0]);
      REQUIRE(test::payloads(log) == wanted);
      for (const auto& run : paces) REQUIRE(log_of(p, divisions, run) == log);
    }
  }
}

TEST_CASE("t_div: divisions and their errors are counted", "[t_div]") {
  clock_domain clock("clock_domain", 100);
  const std::vector<division> divisions{{1, 2}, {2, 1}, {-1, 2}, {0, 1}, {-1, -2}};
  stream_source<division> source("source", {}, divisions);
  stream_sink<quotient> sink("sink", {}, divisions.size());
  t_div unit("t_div", {});
  channel<division> in("in");
  channel<quotient> out("out");
  source.out(in);
  unit.in(in);
  unit.out(out);
  sink.in(out);
  clock.start();
  config::report report;
  unit.statistics().describe(report);
  CHECK(report.values().dump() == R"({"divisions":5,"errors":2})");
}

}  // namespace rtusim
