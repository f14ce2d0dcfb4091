#pragma once

#include <cstdint>

#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"
#include "modules/numeric/divide.h"

namespace rtusim {

/// What the intersector as built does differently (Hanika 2007, sec. 3.3, against sec. 2.1 to 2.3).
struct triangle_errata {
  bool den_wraps = false;
  bool num_wraps = false;
  bool t_halved = false;
  bool uv_low_bits = false;
  bool uv_below_one = false;
  bool t_zero_by_sign = false;

  void describe(config::section& s);
};

/// Raw words of a ray against a triangle's plane.
struct triangle_outcome {
  std::uint64_t u = 0;  ///< barycentric coordinate of vertex 2: m bits, 1.0 = 2^(m-1)
  std::uint64_t v = 0;  ///< of vertex 1
  std::uint64_t t = 0;  ///< distance: n+3 bits, the top one `err`, the others grid units (`t_halved`: n+2 bits, 2 grid units)
  bool hit = false;
  bool err = false;      ///< the distance is negative, or 2^(n+1) grid units or more
  bool wrapped = false;  ///< numerator or denominator did not fit as built
};

/// Intersects a ray with an accelerated triangle, register for register (Hanika 2007, sec. 2.3, 3.3, A.3).
///
/// S = O_r + O_p np + O_q nq; num = d - S; den = dir_r + dir_p np + dir_q nq; t = num / den; k = O + t dir - x0; u = e1p kq - e1q kp; v =
/// e2q kp - e2p kq; a hit when t > 0, u, v >= 0 and u + v <= 1. Products are rounded down. Bits, signed:
///
/// | register | bits | |
/// | --- | --- | --- |
/// | O_p np, O_q nq | n+2 | O_p, O_q are n+1 bits signed, so |product| <= 2^n |
/// | dir_p np, dir_q nq | m+1 | `den_wraps`: m, which only -1.0 times -1.0 leaves |
/// | O_p - pp, O_q - pq | n+1 | wraps for positions outside the scene |
/// | S | n+3 | -2^(n+1) <= S < 2^(n+2) whatever the position; `num_wraps`: n+2, which 3 2^n leaves |
/// | num | n+3 | at most 3 2^n for positions inside the scene |
/// | den | m+2 | at most 3.0; `den_wraps`: m, which sqrt 3 leaves |
/// | quotient | n+3 | {err, t in grid units}; t < 2^(n+1), which a ray across the scene leaves when its direction is much shorter than 1 |
/// | t dir | n+2 | fits without err |
/// | kp, kq | n+2 | may wrap, by 2^(n+2), and is then still 2^n or more in size, so outside every triangle whose edges are not clamped |
/// | u, v | n+m+2 | never wraps, as |e| < 2^(m-1); 1.0 = 2^(m-1+E) |
/// | u + v | n+m+3 | `uv_below_one`: n+m+2, so that a sum far beyond 1 may count as negative |
///
/// The divider has max(n+3, m+1) bits and gets numerator and denominator in a common scale: the low end of the shorter one is filled
/// with zeros. Without `den_wraps` it has 2 bits more, for the denominator's, and the quotient's 2 last bits are left out, so that its
/// others weigh what they did. `division_drop` drops low bits of both operands and makes the divider as many bits narrower; the
/// quotient's bits of that weight are 0.
///
/// Deviation: where the listing writes m for a distance it is n+2 here. They are equal in the listing; here m can be varied alone, as in
/// its figure 2.7.
class triangle_intersector {
 public:
  /// `wide`: 128-bit arithmetic even where 64 bits hold every register. Errors: input_error for a division_drop of n or more.
  triangle_intersector(const quantisation& q, const triangle_errata& errata, bool wide = false);

  unsigned divider_width() const { return divider_.width(); }

  /// `position`: n+1 bits unsigned; `direction`: m bits.
  triangle_outcome operator()(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                              const accelerated_triangle& triangle) const;

  /// The same, but of what is no hit only `hit`, `err` and `wrapped`: most of that is seen without the division.
  triangle_outcome hit_only(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                            const accelerated_triangle& triangle) const;

 private:
  __extension__ using int128 = __int128;
  __extension__ using uint128 = unsigned __int128;

  /// Where the ray meets the triangle's plane.
  struct plane_terms {
    std::int64_t num, den;
    std::int64_t dividend, divisor;  // the same in the divider's scale
    bool wrapped;
  };
  template <class Int, class Unsigned>
  plane_terms terms(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                    const accelerated_triangle& triangle) const;
  template <class Int, class Unsigned>
  triangle_outcome finish(const plane_terms& plane, const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                          const accelerated_triangle& triangle) const;
  /// Whether the ray passes the triangle by more than all roundings of the registers come to, of a plane without err.
  bool surely_misses(const plane_terms& plane, const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                     const accelerated_triangle& triangle) const;
  template <class Int, class Unsigned>
  triangle_outcome hit_only(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                            const accelerated_triangle& triangle) const;

  unsigned n_, m_, edge_shift_;
  triangle_errata errata_;
  numeric::divider divider_;
  bool narrow_;               // whether 64 bits hold every register
  unsigned num_up_, den_up_;  // to the common scale
  unsigned drop_;
  unsigned extra_bits_;  // of the quotient, below grid units
  // For `surely_misses`: 1.0 of u and v, where k and u + v might wrap.
  double one_, k_limit_, sum_limit_;
};

}  // namespace rtusim
