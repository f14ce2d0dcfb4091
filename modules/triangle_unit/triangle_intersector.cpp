#include "modules/triangle_unit/triangle_intersector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "modules/config/error.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim {
namespace {

/// The low `width` bits of a word, sign-extended.
template <class Int, class Unsigned>
Int wrapped(Int word, unsigned width) {
  const unsigned up = static_cast<unsigned>(sizeof(Int) * 8) - width;
  return static_cast<Int>(static_cast<Unsigned>(word) << up) >> up;
}

/// A product modulo the host word: only bits below its width are kept of it.
template <class Int, class Unsigned>
Int product(std::int64_t a, std::int64_t b) {
  return static_cast<Int>(static_cast<Unsigned>(static_cast<Int>(a)) * static_cast<Unsigned>(static_cast<Int>(b)));
}

template <class Int, class Unsigned>
std::int64_t scaled_product(std::int64_t a, std::int64_t b, unsigned shift, unsigned width) {
  return static_cast<std::int64_t>(wrapped<Int, Unsigned>(product<Int, Unsigned>(a, b) >> shift, width));
}

/// The axes r, p and q.
std::array<unsigned, 3> axes_of(const accelerated_triangle& triangle) {
  constexpr std::array<std::array<unsigned, 3>, 4> axes{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 0, 1}}};
  return axes[triangle.r & 3];
}

unsigned divider_width_of(const quantisation& q, const triangle_errata& errata) {
  if (q.division_drop >= q.n)
    throw input_error("quantisation.division_drop", fmt::format("{}", q.division_drop), fmt::format("at most n - 1 = {}", q.n - 1));
  return std::max(q.n + 3, q.m + 1) + (errata.den_wraps ? 0 : 2) - q.division_drop;
}

}  // namespace

triangle_intersector::triangle_intersector(const quantisation& q, const triangle_errata& errata, bool wide)
    : n_(q.n),
      m_(q.m),
      edge_shift_(q.edge_shift),
      errata_(errata),
      divider_(divider_width_of(q, errata)),
      narrow_(!wide && q.n + q.m + 2 <= 64 && q.m <= 32),
      num_up_(q.m > q.n + 2 ? q.m - q.n - 2 : 0),
      den_up_(q.n + 2 > q.m ? q.n + 2 - q.m : 0),
      drop_(q.division_drop),
      extra_bits_(num_up_ + (errata.den_wraps ? 0 : 2)),
      one_(std::ldexp(1.0, static_cast<int>(q.m - 1 + q.edge_shift))),
      k_limit_(std::ldexp(2.0, static_cast<int>(q.n)) - 16),
      sum_limit_(std::ldexp(1.0, static_cast<int>(q.n + q.m + 1))) {}

template <class Int, class Unsigned>
triangle_intersector::plane_terms triangle_intersector::terms(const per_axis<std::int64_t>& position,
                                                              const per_axis<std::int64_t>& direction,
                                                              const accelerated_triangle& triangle) const {
  using numeric::wrap;
  constexpr auto scaled = &scaled_product<Int, Unsigned>;
  const auto [r, p, q] = axes_of(triangle);
  const std::int64_t o_p = wrap(position[p], n_ + 1), o_q = wrap(position[q], n_ + 1);

  const unsigned product_bits = m_ + (errata_.den_wraps ? 0 : 1);
  const std::int64_t whole_s = position[r] + scaled(o_p, triangle.np, m_ - 1, n_ + 2) + scaled(o_q, triangle.nq, m_ - 1, n_ + 2);
  const std::int64_t whole_den =
      direction[r] + scaled(direction[p], triangle.np, m_ - 1, product_bits) + scaled(direction[q], triangle.nq, m_ - 1, product_bits);
  const std::int64_t short_s = wrap(whole_s, n_ + 2), short_den = wrap(whole_den, m_);
  const std::int64_t num = wrap(triangle.d - (errata_.num_wraps ? short_s : whole_s), n_ + 3);
  const std::int64_t den = errata_.den_wraps ? short_den : whole_den;

  const auto aligned = [this](std::int64_t word, unsigned up) { return word * (std::int64_t{1} << up) >> drop_; };
  return {num, den, aligned(num, num_up_), aligned(den, den_up_), short_s != whole_s || short_den != whole_den};
}

template <class Int, class Unsigned>
triangle_outcome triangle_intersector::finish(const plane_terms& plane, const per_axis<std::int64_t>& position,
                                              const per_axis<std::int64_t>& direction, const accelerated_triangle& triangle) const {
  using numeric::wrap;
  constexpr auto scaled = &scaled_product<Int, Unsigned>;
  const auto [r, p, q] = axes_of(triangle);
  const std::int64_t o_p = wrap(position[p], n_ + 1), o_q = wrap(position[q], n_ + 1);
  const numeric::quotient_bits quotient = divider_(plane.dividend, plane.divisor);
  const std::uint64_t distance =
      (extra_bits_ >= drop_ ? quotient.magnitude >> (extra_bits_ - drop_) : quotient.magnitude << (drop_ - extra_bits_)) |
      std::uint64_t{quotient.err} << (n_ + 2);
  const unsigned halved = errata_.t_halved;
  const std::uint64_t t = distance >> halved;
  const std::int64_t signed_t = wrap(static_cast<std::int64_t>(t), n_ + 3 - halved);

  const std::int64_t k_p = wrap(wrap(o_p - triangle.pp, n_ + 1) + scaled(signed_t, direction[p], m_ - 1 - halved, n_ + 2), n_ + 2);
  const std::int64_t k_q = wrap(wrap(o_q - triangle.pq, n_ + 1) + scaled(signed_t, direction[q], m_ - 1 - halved, n_ + 2), n_ + 2);

  const auto difference = [&](std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    const Unsigned wide = static_cast<Unsigned>(product<Int, Unsigned>(a, b)) - static_cast<Unsigned>(product<Int, Unsigned>(c, d));
    return wrapped<Int, Unsigned>(static_cast<Int>(wide), n_ + m_ + 2);
  };
  const Int u = difference(triangle.e1p, k_q, triangle.e1q, k_p);
  const Int v = difference(triangle.e2q, k_p, triangle.e2p, k_q);
  const Unsigned sum = static_cast<Unsigned>(u) + static_cast<Unsigned>(v);
  const Int one = Int{1} << (m_ - 1 + edge_shift_);
  const bool inside =
      u >= 0 && v >= 0 &&
      (errata_.uv_below_one ? wrapped<Int, Unsigned>(static_cast<Int>(sum), n_ + m_ + 2) < one : sum <= static_cast<Unsigned>(one));

  const unsigned uv_down = errata_.uv_low_bits ? 0 : edge_shift_;
  const std::uint64_t uv_mask = (std::uint64_t{1} << m_) - 1;
  triangle_outcome o;
  o.u = static_cast<std::uint64_t>(u >> uv_down) & uv_mask;
  o.v = static_cast<std::uint64_t>(v >> uv_down) & uv_mask;
  o.t = t;
  o.hit = !quotient.err && inside && (errata_.t_zero_by_sign || plane.num != 0);
  o.err = quotient.err;
  o.wrapped = plane.wrapped;
  return o;
}

bool triangle_intersector::surely_misses(const plane_terms& plane, const per_axis<std::int64_t>& position,
                                         const per_axis<std::int64_t>& direction, const accelerated_triangle& triangle) const {
  // The registers lose less than 2 grid units of t and 1 of each product, so that k is off by less than `lost`; binary64 loses far less
  // than the share of the products that is added to that.
  constexpr double lost = 4, rounding = 0x1p-40;
  const auto [r, p, q] = axes_of(triangle);
  if (drop_ != 0 || (position[p] | position[q]) >> n_ != 0) return false;
  // As built the divider takes this one for 0.
  if (plane.num == -(std::int64_t{4} << n_)) return false;
  const auto real = [](std::int64_t word) { return static_cast<double>(word); };
  const double t = real(plane.num) / real(plane.den);  // in units of 2^(m-1) grid units
  const double k_p = real(position[p] - triangle.pp) + t * real(direction[p]),
               k_q = real(position[q] - triangle.pq) + t * real(direction[q]);
  if (!(std::max(std::fabs(k_p), std::fabs(k_q)) < k_limit_)) return false;
  const double e1p = real(triangle.e1p), e1q = real(triangle.e1q), e2p = real(triangle.e2p), e2q = real(triangle.e2q);
  const double u = e1p * k_q - e1q * k_p, v = e2q * k_p - e2p * k_q;
  const double u_off = lost * (std::fabs(e1p) + std::fabs(e1q)) + rounding * (std::fabs(e1p * k_q) + std::fabs(e1q * k_p));
  const double v_off = lost * (std::fabs(e2p) + std::fabs(e2q)) + rounding * (std::fabs(e2q * k_p) + std::fabs(e2p * k_q));
  return u < -u_off || v < -v_off || (u + v > one_ + u_off + v_off && u + v < sum_limit_ - u_off - v_off);
}

template <class Int, class Unsigned>
triangle_outcome triangle_intersector::hit_only(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                                                const accelerated_triangle& triangle) const {
  const plane_terms plane = terms<Int, Unsigned>(position, direction, triangle);
  triangle_outcome o;
  o.wrapped = plane.wrapped;
  o.err = divider_.errs(plane.dividend, plane.divisor);
  if (o.err || surely_misses(plane, position, direction, triangle)) return o;
  return finish<Int, Unsigned>(plane, position, direction, triangle);
}

triangle_outcome triangle_intersector::operator()(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                                                  const accelerated_triangle& triangle) const {
  if (narrow_)
    return finish<std::int64_t, std::uint64_t>(terms<std::int64_t, std::uint64_t>(position, direction, triangle), position, direction,
                                               triangle);
  return finish<int128, uint128>(terms<int128, uint128>(position, direction, triangle), position, direction, triangle);
}

triangle_outcome triangle_intersector::hit_only(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                                                const accelerated_triangle& triangle) const {
  return narrow_ ? hit_only<std::int64_t, std::uint64_t>(position, direction, triangle)
                 : hit_only<int128, uint128>(position, direction, triangle);
}

void triangle_errata::describe(config::section& s) {
  s.erratum("den_wraps", den_wraps, "the denominator wraps at m bits", "m + 2 bits, and a divider 2 bits wider");
  s.erratum("num_wraps", num_wraps, "the sum that is taken from d wraps at n + 2 bits", "n + 3 bits");
  s.erratum("t_halved", t_halved, "the distance loses its last bit", "whole grid units");
  s.erratum("uv_low_bits", uv_low_bits, "u and v leave as their low m bits", "as bits E and up, so that 1.0 is 2^(m-1)");
  s.erratum("uv_below_one", uv_below_one, "a hit needs u + v < 1, in a sum that wraps", "u + v <= 1, in a sum one bit wider");
  s.erratum("t_zero_by_sign", t_zero_by_sign, "a ray that starts in the plane hits when it leaves against the normal axis",
            "it does not hit");
}

}  // namespace rtusim
