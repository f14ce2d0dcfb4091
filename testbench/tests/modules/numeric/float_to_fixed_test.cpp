#include "modules/numeric/float_to_fixed.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include "testbench/tests/random.h"

namespace rtusim::numeric {
namespace {

std::uint32_t bits_of(float f) {
  std::uint32_t b;
  std::memcpy(&b, &f, sizeof b);
  return b;
}
float float_of(std::uint32_t b) {
  float f;
  std::memcpy(&f, &b, sizeof f);
  return f;
}

/// Truncation toward zero and saturation in binary64, which holds every binary32 scaled by a power of two.
std::int64_t reference(std::uint32_t bits, const fixed_format& format) {
  const double value = float_of(bits);
  if (std::isnan(value)) return std::signbit(value) ? format.least() : format.greatest();
  const double scaled = std::trunc(std::ldexp(value, static_cast<int>(format.fraction_bits)));
  const double limit = std::ldexp(1.0, static_cast<int>(format.width()) - 1);
  if (scaled >= limit) return format.greatest();
  if (scaled < -limit) return format.least();
  return static_cast<std::int64_t>(scaled);
}

}  // namespace

TEST_CASE("float_to_fixed: the right converter truncates and saturates, at every width", "[numeric]") {
  test::rng random(1);
  float_to_fixed_stats stats;
  for (const fixed_format format : {fixed_format{16, 16}, {8, 24}, {24, 8}, {2, 1}, {32, 32}, {12, 12}, {20, 29}}) {
    for (int i = 0; i < 50'000; ++i) {
      std::uint32_t bits = random();
      if (i % 2 == 0) bits = (bits & 0x807fffff) | (100u + random() % 60) << 23;  // near the range
      CAPTURE(format.integer_bits, format.fraction_bits, bits);
      REQUIRE(float_to_fixed(bits, format, {}, stats) == reference(bits, format));
    }
  }
}

TEST_CASE("float_to_fixed: a format of which flush_small leaves only the ends", "[numeric]") {
  test::rng random(2);
  const fixed_format format{2, 1};
  float_to_fixed_stats stats;
  for (int i = 0; i < 50'000; ++i) {
    std::uint32_t bits = random();
    if (i % 2 == 0) bits = (bits & 0x807fffff) | (110u + random() % 30) << 23;
    const bool small = std::fabs(float_of(bits)) < 2;
    CAPTURE(bits);
    REQUIRE(float_to_fixed(bits, format, {false, true, false}, stats) == (small ? 0 : reference(bits, format)));
    REQUIRE(float_to_fixed(bits, format, {true, true, true}, stats) == 0);
  }
}

TEST_CASE("float_to_fixed: what does not keep its value is counted", "[numeric]") {
  struct row {
    float value;
    std::int64_t right, as_built;
    std::uint64_t overflows, nans, flushed;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const row rows[] = {
      {1.0f, 65536, 65536, 0, 0, 0},
      {-1.5f, -98304, -98304, 0, 0, 0},
      {32768.0f, 0x7fffffff, 0, 1, 0, 0},
      {-32768.0f, -0x7fffffff - 1, 0, 0, 0, 0},
      {-32769.0f, -0x7fffffff - 1, 0, 1, 0, 0},
      {inf, 0x7fffffff, 0, 1, 0, 0},
      {-inf, -0x7fffffff - 1, 0, 1, 0, 0},
      {nan, 0x7fffffff, 0, 0, 1, 0},
      {std::ldexp(1.0f, -15), 2, 0, 0, 0, 0},
      {std::ldexp(1.0f, -17), 0, 0, 0, 0, 1},
      {2.0f + std::ldexp(1.0f, -16), 131073, 131072, 0, 0, 0},
      {-0.0f, 0, 0, 0, 0, 0},
  };
  for (const row& r : rows) {
    CAPTURE(r.value);
    float_to_fixed_stats stats;
    CHECK(float_to_fixed(bits_of(r.value), {}, {}, stats) == r.right);
    CHECK(stats.overflows == r.overflows);
    CHECK(stats.nans == r.nans);
    CHECK(stats.flushed == r.flushed);
    CHECK(float_to_fixed(bits_of(r.value), {}, {true, true, true}, stats) == r.as_built);
  }
}

}  // namespace rtusim::numeric
