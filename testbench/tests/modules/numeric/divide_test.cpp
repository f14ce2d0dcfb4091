#include "modules/numeric/divide.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <string>

#include "modules/config/csv.h"
#include "modules/numeric/fixed_point.h"
#include "testbench/tests/random.h"

namespace rtusim::numeric {
namespace {

struct expected {
  std::uint64_t magnitude;
  bool err;
};

/// The steps of the hardware, with a remainder of width - 1 bits that is a signed number.
expected by_steps(std::int64_t n, std::int64_t d, unsigned width) {
  const std::uint64_t mask = (std::uint64_t{1} << (width - 1)) - 1;
  const auto size = [mask](std::int64_t word) {
    const auto bits = static_cast<std::uint64_t>(word);
    return (word < 0 ? 0 - bits : bits) & mask;
  };
  const auto wrapped = [width](std::uint64_t bits) { return wrap(static_cast<std::int64_t>(bits), width - 1); };
  const std::uint64_t a = size(n), b = size(d);
  std::int64_t remainder = wrapped(a - b);
  std::uint64_t magnitude = remainder >= 0;
  for (unsigned bit = 2; bit < width; ++bit) {
    const std::uint64_t doubled = static_cast<std::uint64_t>(remainder) * 2;
    remainder = wrapped(remainder >= 0 ? doubled - b : doubled + b);
    magnitude = 2 * magnitude + (remainder >= 0);
  }
  return {magnitude, (n < 0) != (d < 0) || a >= b};
}

void require_steps(const divider& divide, std::int64_t n, std::int64_t d) {
  const quotient_bits q = divide(n, d);
  const expected e = by_steps(n, d, divide.width());
  if (q.magnitude == e.magnitude && q.err == e.err) return;
  CAPTURE(divide.width(), n, d);
  CHECK(q.err == e.err);
  REQUIRE(q.magnitude == e.magnitude);
}

}  // namespace

TEST_CASE("divider: every pair of words of 4 to 9 bits", "[numeric]") {
  for (unsigned width = 4; width <= 9; ++width) {
    const divider divide(width);
    const std::int64_t half = std::int64_t{1} << (width - 1);
    for (std::int64_t n = -half; n < half; ++n)
      for (std::int64_t d = -half; d < half; ++d) require_steps(divide, n, d);
  }
}

TEST_CASE("divider: random words and the ends of the range at every width", "[numeric]") {
  test::rng random(3);
  const auto word = [&](unsigned width) {
    const auto bits = static_cast<std::int64_t>(std::uint64_t{random()} << 32 | random());
    return wrap(bits, width) >> random() % width;  // of all sizes
  };
  for (unsigned width = least_divider_width; width <= most_divider_width; ++width) {
    const divider divide(width);
    const std::int64_t least = wrap(static_cast<std::int64_t>(std::uint64_t{1} << (width - 1)), width);
    const std::int64_t ends[] = {0, 1, -1, least, least + 1, ~least, ~least - 1, least / 2, -(least / 2), least / 2 - 1, -(least / 2) + 1};
    for (const std::int64_t n : ends)
      for (const std::int64_t d : ends) require_steps(divide, n, d);
    for (int i = 0; i < 20'000; ++i) require_steps(divide, word(width), word(width));
  }
}

TEST_CASE("divider: where it is defined, the quotient is the one of whole numbers, rounded down", "[numeric]") {
  const divider divide(33);
  CHECK(divide(1, 2).magnitude == std::uint64_t{1} << 30);
  CHECK(divide(1, 3).magnitude == (std::uint64_t{1} << 31) / 3);
  CHECK(divide(-1, -3).word(33) == (std::uint64_t{1} << 31) / 3);
  CHECK(divide(-1, 3).word(33) == ((std::uint64_t{1} << 31) / 3 | std::uint64_t{1} << 32));
  CHECK(divide(3, 3).err);
  CHECK(divide(0, 0).err);
  CHECK(divide(0, -1).err);
  CHECK_FALSE(divide(0, 1).err);
}

TEST_CASE("divider: every row of the golden files", "[numeric]") {
  for (const unsigned width : {16U, 32U}) {
    const csv_table table(RTUSIM_SOURCE_DIR "/testbench/golden/bih/tdiv_w" + std::to_string(width) + ".csv.gz");
    const auto n = table.column("n"), d = table.column("d"), q = table.column("q"), err = table.column("err");
    const divider divide(width);
    const std::int64_t most = std::int64_t{1} << 32;
    REQUIRE(table.rows() == 15'000);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const quotient_bits result = divide(table.number(row, n, -most, most), table.number(row, d, -most, most));
      REQUIRE(static_cast<std::int64_t>(result.word(width)) == table.number(row, q, 0, most));
      REQUIRE(result.err == (table.number(row, err, 0, 1) != 0));
    }
  }
}

}  // namespace rtusim::numeric
