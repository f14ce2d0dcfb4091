#include "modules/numeric/fixed_point.h"

#include <catch2/catch.hpp>

#include <cstdint>

namespace rtusim::numeric {

TEST_CASE("fixed_point: a format knows its ends", "[numeric]") {
  const fixed_format narrow{3, 2};
  CHECK(narrow.greatest() == 15);
  CHECK(narrow.least() == -16);
  CHECK(narrow.value(-6) == -1.5);
  const fixed_format wide{32, 32};
  CHECK(wide.greatest() == INT64_MAX);
  CHECK(wide.least() == INT64_MIN);
}

TEST_CASE("fixed_point: wrap keeps the low bits and extends the sign", "[numeric]") {
  for (std::int64_t v = -300; v <= 300; ++v) {
    const std::int64_t low = ((v % 32) + 32) % 32;
    CHECK(wrap(v, 5) == (low >= 16 ? low - 32 : low));
  }
  CHECK(wrap(INT64_MIN, 64) == INT64_MIN);
}

TEST_CASE("fixed_point: midpoints round down, with and without the carry", "[numeric]") {
  for (std::int64_t a = -128; a < 128; ++a) {
    for (std::int64_t b = -128; b < 128; ++b) {
      const std::int64_t floor_half = (a + b) >> 1;
      REQUIRE(midpoint<std::int64_t>(a, b) == floor_half);
      REQUIRE(midpoint<std::int32_t>(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)) == floor_half);
      REQUIRE(wrapped_midpoint<std::int64_t, std::uint64_t>(a, b, 8) == wrap(a + b, 8) >> 1);
      REQUIRE(wrapped_midpoint<std::int32_t, std::uint32_t>(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), 8) ==
              wrap(a + b, 8) >> 1);
    }
  }
  CHECK(midpoint<std::int64_t>(INT64_MAX, INT64_MAX) == INT64_MAX);
  CHECK(wrapped_midpoint<std::int32_t, std::uint32_t>(INT32_MAX, 1, 32) == INT32_MIN / 2);
}

}  // namespace rtusim::numeric
