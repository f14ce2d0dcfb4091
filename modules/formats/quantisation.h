#pragma once

#include <cstdint>

#include "modules/config/section.h"
#include "modules/formats/packets.h"

namespace rtusim {

/// Widths of the triangle tracer's numbers (Hanika 2007, sec. 2.1, 2.2): coordinates in grid units of `n` bits, and what is derived from
/// them.
struct quantisation {
  unsigned n = 30;                ///< coordinates: unsigned, the scene's longest side is 2^n - 1
  unsigned m = 32;                ///< directions, normals, edges: signed; 1.0 of directions and normals = 2^(m-1)
  unsigned edge_shift = 10;       ///< E: edges' 1.0 = 2^(m-1+E), so that they lie in (-2^-E, 2^-E)
  unsigned reciprocal_bits = 16;  ///< C: reciprocal directions have m + C bits, 1.0 = 2^C
  unsigned division_drop = 0;     ///< T: low bits dropped from numerator and denominator before the division
  bool fit_edges = false;         ///< E is the host's choice as it puts a mesh on the grid, see `quantise`

  static constexpr unsigned greatest_edge_shift = 20;
  std::int64_t greatest_coordinate() const { return (std::int64_t{1} << n) - 1; }
  std::int64_t greatest_direction() const { return (std::int64_t{1} << (m - 1)) - 1; }

  void describe(config::section& s);
};

/// A triangle as the intersector reads it (Hanika 2007, sec. 2.1.3; Badouel, Wald): `r` is the axis of the largest normal component,
/// p and q the next two. Raw words of the widths of `quantisation`, sign-extended.
struct accelerated_triangle {
  std::int64_t pp = 0, pq = 0;    ///< vertex 0, n bits unsigned
  std::int64_t d = 0;             ///< n+3 bits, grid units: <n,x0> / n_r
  std::int64_t e1p = 0, e1q = 0;  ///< m bits, 1.0 = 2^(m-1+E): (x1 - x0) / n_r
  std::int64_t e2p = 0, e2q = 0;  ///< the same of vertex 2
  std::int64_t np = 0, nq = 0;    ///< m bits, 1.0 = 2^(m-1): n_p / n_r, n_q / n_r
  std::uint8_t r = 0;             ///< 0, 1, 2; 3 acts as 2
};

/// A ray as the hierarchy's core and the intersector see it.
struct quantised_ray {
  per_axis<std::int64_t> position{};    ///< n bits unsigned, grid units (the intersector takes n+1)
  per_axis<std::int64_t> direction{};   ///< m bits, 1.0 = 2^(m-1)
  per_axis<std::int64_t> reciprocal{};  ///< m+C bits, 1.0 = 2^C
  bool misses_box = false;              ///< found as it was clipped to the scene's box
};

}  // namespace rtusim
