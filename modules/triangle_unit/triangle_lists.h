#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"
#include "modules/triangle_unit/triangle_intersector.h"

namespace rtusim {

/// Triangles in the order in which leaves list them, so that many are tested against a ray at a time: four side by side on a processor with
/// AVX2. It tells err and wrapped of those that the ray surely misses; the others are left to the intersector.
///
/// Covers words of n <= 30 and m <= 32 without division_drop, den_wraps and num_wraps. Products of 31 and 32 bits fit 64, sums and
/// numerators have 34 bits at most and are exact in binary64.
class triangle_lists {
 public:
  /// Whether these words, on this processor, are covered.
  static bool covers(const quantisation& q, const triangle_errata& errata);

  /// `numbers`: of `triangles`, as the lists' words have them; those that name none are open. `q` and errata must be covered.
  triangle_lists(const quantisation& q, const std::vector<std::uint32_t>& numbers, const std::vector<accelerated_triangle>& triangles);

  /// Of up to 64 triangles.
  struct verdict {
    std::uint64_t open = 0;  ///< bit i: the intersector must tell what becomes of triangle i
    unsigned errors = 0;     ///< of the others
    unsigned wrapped = 0;
  };
  static constexpr std::uint32_t most = 64;

  /// The `count` triangles, 64 at most, from list address `first` on. `position` and `direction` as for `triangle_intersector`.
  verdict operator()(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction, std::uint32_t first,
                     std::uint32_t count) const;

  /// What it knows of the words and the triangles.
  struct tables {
    unsigned n, m;
    double num_scale, den_scale;  // to the divider's
    double one, k_limit, sum_limit;
    // Each in the order of the lists, with room for three more.
    std::vector<double> d;
    std::vector<std::int32_t> pp, pq, e1p, e1q, e2p, e2q, np, nq, r;
    std::vector<std::uint8_t> there;
  };

 private:
  tables tables_;
};

}  // namespace rtusim
