#include "testbench/bench/lfsr.h"

namespace rtusim {

lfsr::lfsr(std::uint16_t seed) : states_(period), ones_before_(period + 1) {
  std::uint16_t x = seed;
  for (unsigned i = 0; i < period; ++i, x = step(x)) {
    states_[i] = x;
    ones_before_[i + 1] = ones_before_[i] + (x & 1);
  }
}

cycle lfsr::next(cycle c) const {
  while ((state(c) & 1) == 0) ++c;  // at most 15 zeros in a row
  return c;
}

std::uint64_t lfsr::count(cycle from, cycle to) const { return from < to ? count_before(to) - count_before(from) : 0; }

}  // namespace rtusim
