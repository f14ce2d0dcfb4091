#include "testbench/bench/histogram.h"

#include <cmath>
#include <numeric>

namespace rtusim {

std::uint64_t histogram::total() const { return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}); }

std::uint64_t histogram::sum() const {
  std::uint64_t s = 0;
  for (std::size_t v = 0; v < counts_.size(); ++v) s += v * counts_[v];
  return s;
}

std::uint64_t histogram::percentile(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(total())));
  std::uint64_t seen = 0;
  for (std::size_t v = 0; v < counts_.size(); ++v) {
    seen += counts_[v];
    if (seen >= wanted && seen > 0) return v;
  }
  return 0;
}

void histogram::describe(config::report& r, std::string_view unit) const {
  const std::uint64_t n = total();
  r.number("mean", n == 0 ? 0.0 : static_cast<double>(sum()) / static_cast<double>(n), unit, "arithmetic mean");
  r.number("least", percentile(0), unit, "least value");
  r.number("p50", percentile(0.5), unit, "half of the values do not exceed it");
  r.number("p90", percentile(0.9), unit, "nine in ten values do not exceed it");
  r.number("p99", percentile(0.99), unit, "99 in 100 values do not exceed it");
  r.number("most", percentile(1), unit, "greatest value");
  nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
  for (std::size_t v = 0; v < counts_.size(); ++v)
    if (counts_[v] != 0) pairs.push_back(nlohmann::ordered_json::array_t{v, counts_[v]});
  r.number("histogram", pairs, unit, "pairs of a value and how often it came");
}

}  // namespace rtusim
