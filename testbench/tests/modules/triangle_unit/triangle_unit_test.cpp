#include "modules/triangle_unit/triangle_unit.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"
#include "testbench/tests/pipeline_run.h"

namespace rtusim {
namespace {

using numeric::divider_kind;

std::string text(const triangle_result& r) { return fmt::format("{} {} {:x} {:x} {:x}", r.rdy, r.hit, r.u, r.v, r.t); }

std::string log_of(const triangle_unit_params& p, const std::vector<triangle_request>& requests, const test::pipeline_run& run) {
  return test::pipeline_log<triangle_unit, triangle_request, triangle_result>(p, requests, run,
                                                                              [](const triangle_result& r) { return text(r); });
}

std::string wanted_of(const triangle_unit_params& p, const std::vector<triangle_request>& requests) {
  const triangle_intersector intersect(p.words, p.errata);
  std::string all;
  for (const triangle_request& r : requests) {
    const triangle_outcome o = intersect(r.position, r.direction, r.triangle);
    all += text({o.u, o.v, o.t, r.enable, o.hit}) + '\n';
  }
  return all;
}

}  // namespace

TEST_CASE("triangle_unit: 41 clocks as built, 43 with the wider divider, one pair in each or in as many as the divider has bits",
          "[triangle_unit]") {
  struct row {
    triangle_unit_params p;
    cycle latency, interval;
  };
  const auto with = [](const triangle_errata& errata, const quantisation& q, divider_kind kind) {
    return triangle_unit_params{errata, q, kind};
  };
  quantisation dropped;
  dropped.division_drop = 8;
  const row rows[] = {{with(test::triangles_as_built, {}, divider_kind::pipelined), 41, 1},
                      {with({}, {}, divider_kind::pipelined), 43, 1},
                      {with(test::triangles_as_built, {}, divider_kind::iterative), 41, 33},
                      {with({}, dropped, divider_kind::iterative), 35, 27},
                      {with(test::triangles_as_built, {13, 15, 4, 0, 0}, divider_kind::pipelined), 24, 1}};
  const std::vector<triangle_request> requests(3);
  for (const row& r : rows) {
    CAPTURE(r.latency, r.interval);
    CHECK(triangle_unit::stages_of(r.p) == r.latency);
    const std::string log = log_of(r.p, requests, {});
    std::string wanted_in, wanted_out;
    const std::string payload = test::payloads(log).substr(0, test::payloads(log).find('\n'));
    for (cycle i = 0; i < 3; ++i) {
      wanted_in += fmt::format("{} in \n", i * r.interval);
      wanted_out += fmt::format("{} out {}\n", i * r.interval + r.latency, payload);
    }
    CHECK(log == wanted_in + wanted_out);
  }
}

TEST_CASE("triangle_unit: the plain function's words in any design, whatever stalls, in every pace", "[triangle_unit]") {
  test::rng random(12);
  for (int design = 0; design < 8; ++design) {
    triangle_unit_params p;
    p.errata = test::random_errata(random);
    p.words = test::random_words(random);
    p.divider = static_cast<divider_kind>(design % 2);
    std::vector<triangle_request> requests(200);
    for (triangle_request& r : requests) r = test::random_request(random, p.words);
    const std::string wanted = wanted_of(p, requests);
    for (const auto& paces : test::stalled_runs(random() % 1000 + 1)) {
      CAPTURE(design, p.words.n, p.words.m, static_cast<int>(paces[0].source), static_cast<int>(paces[0].sink));
      const std::string log = log_of(p, requests, paces[0]);
      REQUIRE(test::payloads(log) == wanted);
      for (const auto& run : paces) REQUIRE(log_of(p, requests, run) == log);
    }
  }
}

TEST_CASE("triangle_unit: enabled pairs are counted, what they come to as well", "[triangle_unit]") {
  const auto rows = test::golden_triangles();
  std::vector<triangle_request> requests;
  std::uint64_t pairs = 0, hits = 0, errors = 0;
  for (const test::triangle_vector& v : rows) {
    requests.push_back(v.request);
    if (!v.request.enable) continue;
    ++pairs;
    hits += v.result.hit;
    errors += v.result.t >> 31 & 1;
  }
  clock_domain clock("clock_domain", 100);
  stream_source<triangle_request> source("source", {}, requests);
  stream_sink<triangle_result> sink("sink", {}, requests.size());
  triangle_unit unit("triangle_unit", {test::triangles_as_built, {}, divider_kind::pipelined});
  channel<triangle_request> in("in");
  channel<triangle_result> out("out");
  source.out(in);
  unit.in(in);
  unit.out(out);
  sink.in(out);
  clock.start();
  const triangle_unit::stats& s = unit.statistics();
  CHECK(pairs < requests.size());
  CHECK(s.pairs == pairs);
  CHECK(s.hits == hits);
  CHECK(s.errors == errors);
  CHECK(s.wrapped > 0);
  config::report report;
  s.describe(report);
  CHECK(report.entries().size() == 4);
}

}  // namespace rtusim
