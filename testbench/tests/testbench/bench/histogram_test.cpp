#include "testbench/bench/histogram.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>
#include "testbench/tests/random.h"

namespace rtusim {

TEST_CASE("histogram: percentiles are those of the sorted values", "[testbench]") {
  test::rng random(2);
  histogram h;
  CHECK(h.percentile(0.5) == 0);
  std::vector<std::uint64_t> values;
  for (int i = 0; i < 999; ++i) {
    values.push_back(random() % 300 + (i == 500 ? 100'000 : 0));
    h.add(values.back());
  }
  std::sort(values.begin(), values.end());
  CHECK(h.total() == 999);
  CHECK(h.percentile(0) == values.front());
  CHECK(h.percentile(0.5) == values[499]);
  CHECK(h.percentile(0.99) == values[989]);
  CHECK(h.percentile(1) == values.back());
  std::uint64_t sum = 0;
  for (const auto v : values) sum += v;
  CHECK(h.sum() == sum);
}

}  // namespace rtusim
