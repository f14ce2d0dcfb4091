#pragma once

#include <cstdint>
#include <random>

namespace rtusim::test {

/// std::mt19937, whose numbers are 64-bit words on this platform, with 32-bit ones.
using rng = std::mersenne_twister_engine<std::uint32_t, 32, 624, 397, 31, 0x9908b0df, 11, 0xffffffff, 7, 0x9d2c5680, 15, 0xefc60000, 18,
                                         1812433253>;

}  // namespace rtusim::test
