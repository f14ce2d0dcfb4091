#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "modules/config/csv.h"
#include "modules/numeric/fixed_point.h"
#include "modules/triangle_unit/triangle_unit.h"
#include "testbench/tests/random.h"

/// Rays and triangles for the intersector.
namespace rtusim::test {

inline constexpr triangle_errata triangles_as_built{true, true, true, true, true, true};

/// A row of the golden file.
struct triangle_vector {
  triangle_request request;
  triangle_result result;
  int exact_hit = -1;  // -1: the row is random words
};

inline std::vector<triangle_vector> golden_triangles() {
  const csv_table table(RTUSIM_SOURCE_DIR "/testbench/golden/bih/tri_int_n30_m32.csv.gz");
  const auto words = [&](std::initializer_list<const char*> names) {
    std::vector<std::size_t> at;
    for (const char* name : names) at.push_back(table.column(name));
    return at;
  };
  const auto columns = words({"en", "pos_x", "pos_y", "pos_z", "dir_x", "dir_y", "dir_z", "r", "pp", "pq", "d",     "np",
                              "nq", "e1p",   "e1q",   "e2p",   "e2q",   "rdy",   "hit",   "u", "v",  "t",  "mt_hit"});
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  std::vector<triangle_vector> all(table.rows());
  for (std::size_t row = 0; row < all.size(); ++row) {
    auto column = columns.begin();
    const auto next = [&] { return table.number(row, *column++, -most, most); };
    triangle_request& q = all[row].request;
    accelerated_triangle& a = q.triangle;
    q.enable = next() != 0;
    for (std::int64_t& word : q.position) word = next();
    for (std::int64_t& word : q.direction) word = next();
    a.r = static_cast<std::uint8_t>(next());
    for (std::int64_t* word : {&a.pp, &a.pq, &a.d, &a.np, &a.nq, &a.e1p, &a.e1q, &a.e2p, &a.e2q}) *word = next();
    triangle_result& r = all[row].result;
    r.rdy = next() != 0;
    r.hit = next() != 0;
    for (std::uint64_t* word : {&r.u, &r.v, &r.t}) *word = static_cast<std::uint64_t>(next());
    all[row].exact_hit = static_cast<int>(next());
  }
  return all;
}

/// Any widths that a design may have.
inline quantisation random_words(rng& random) {
  quantisation q;
  q.n = 4 + random() % 29;
  q.m = random() % 2 == 0 ? q.n + 2 : 4 + random() % 31;
  q.edge_shift = random() % 21;
  q.division_drop = random() % 2 == 0 ? 0 : random() % std::min(q.n, 25U);
  return q;
}

inline triangle_errata random_errata(rng& random) {
  const auto flag = [&] { return random() % 2 != 0; };
  return {flag(), flag(), flag(), flag(), flag(), flag()};
}

/// Words of any bits, of all sizes.
inline triangle_request random_request(rng& random, const quantisation& q) {
  const auto bits = [&] { return static_cast<std::int64_t>(std::uint64_t{random()} << 32 | random()); };
  const auto is_signed = [&](unsigned width) {
    if (random() % 16 == 0) return random() % 2 == 0 ? -(std::int64_t{1} << (width - 1)) : (std::int64_t{1} << (width - 1)) - 1;
    return numeric::wrap(bits(), width) >> random() % width;
  };
  const auto is_unsigned = [&](unsigned width) {
    return (bits() & ((std::int64_t{1} << width) - 1)) >> (random() % 2 == 0 ? 0 : random() % width);
  };
  triangle_request request;
  for (std::int64_t& word : request.position) word = is_unsigned(q.n + 1);
  for (std::int64_t& word : request.direction) word = is_signed(q.m);
  accelerated_triangle& a = request.triangle;
  for (std::int64_t* word : {&a.pp, &a.pq}) *word = is_unsigned(q.n);
  a.d = is_signed(q.n + 3);
  for (std::int64_t* word : {&a.e1p, &a.e1q, &a.e2p, &a.e2q, &a.np, &a.nq}) *word = is_signed(q.m);
  a.r = static_cast<std::uint8_t>(random() % 4);
  request.enable = random() % 4 != 0;
  return request;
}

}  // namespace rtusim::test
