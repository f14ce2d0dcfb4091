#include <catch2/catch.hpp>

#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include "testbench/bench/histogram.h"

// The distributions of a record on lists whose figures one knows by heart.
namespace rtusim {
namespace {

using json = nlohmann::ordered_json;

json described(const std::vector<std::uint64_t>& values) {
  histogram h;
  for (const std::uint64_t v : values) h.add(v);
  config::report r;
  h.describe(r, "cycles");
  return r.values();
}

std::vector<std::uint64_t> counted(std::uint64_t first, std::uint64_t last) {
  std::vector<std::uint64_t> all;
  for (std::uint64_t v = first; v <= last; ++v) all.push_back(v);
  return all;
}

}  // namespace

TEST_CASE("percentiles: of lists with known answers", "[testbench]") {
  const struct {
    std::vector<std::uint64_t> values;
    double mean;
    std::uint64_t least, p50, p90, p99, most;
  } lists[] = {
      {counted(1, 100), 50.5, 1, 50, 90, 99, 100},
      {counted(1, 101), 51, 1, 51, 91, 100, 101},
      {counted(1, 1000), 500.5, 1, 500, 900, 990, 1000},
      {counted(1, 10), 5.5, 1, 5, 9, 10, 10},
      {counted(1, 11), 6, 1, 6, 10, 11, 11},
      {counted(0, 19), 9.5, 0, 9, 17, 19, 19},
      {{7}, 7, 7, 7, 7, 7, 7},
      {{2, 1}, 1.5, 1, 1, 2, 2, 2},
      {{0, 0, 0}, 0, 0, 0, 0, 0, 0},
      {{5, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 1.4, 1, 1, 1, 5, 5},
      {{5, 5, 1, 1, 1, 1, 1, 1, 1, 1}, 1.8, 1, 1, 5, 5, 5},
      {{64, 63, 65, 64}, 64, 63, 64, 65, 65, 65},
      {{100'000, 3}, 50'001.5, 3, 3, 100'000, 100'000, 100'000},
      {{}, 0, 0, 0, 0, 0, 0},
  };
  for (const auto& l : lists) {
    CAPTURE(l.values);
    const json d = described(l.values);
    CHECK(d["mean"].get<double>() == Approx(l.mean).margin(1e-12));
    CHECK(d["least"] == l.least);
    CHECK(d["p50"] == l.p50);
    CHECK(d["p90"] == l.p90);
    CHECK(d["p99"] == l.p99);
    CHECK(d["most"] == l.most);
  }
}

TEST_CASE("percentiles: the histogram counts each value, 0 and the greatest among them", "[testbench]") {
  CHECK(described({3, 0, 3, 900, 0, 3})["histogram"] == json::parse("[[0,2],[3,3],[900,1]]"));
  CHECK(described({})["histogram"] == json::array());
  CHECK(described({63, 64})["histogram"] == json::parse("[[63,1],[64,1]]"));
}

}  // namespace rtusim
