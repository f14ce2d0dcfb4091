#include "modules/triangle_unit/triangle_lists.h"

#include <algorithm>
#include <cmath>

#include "modules/config/error.h"
#include "modules/numeric/avx2.h"

#if RTU_HAS_AVX2
#include <immintrin.h>
#endif

namespace rtusim {

bool triangle_lists::covers(const quantisation& q, const triangle_errata& errata) {
  return numeric::has_avx2() && q.n <= 30 && q.m <= 32 && q.division_drop == 0 && !errata.den_wraps && !errata.num_wraps;
}

triangle_lists::triangle_lists(const quantisation& q, const std::vector<std::uint32_t>& numbers,
                               const std::vector<accelerated_triangle>& triangles)
    : tables_{q.n, q.m, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}} {
  const auto power = [](unsigned bits) { return std::ldexp(1.0, static_cast<int>(bits)); };
  tables_.num_scale = q.m > q.n + 2 ? power(q.m - q.n - 2) : 1;
  tables_.den_scale = q.n + 2 > q.m ? power(q.n + 2 - q.m) : 1;
  tables_.one = power(q.m - 1 + q.edge_shift);
  tables_.k_limit = power(q.n + 1) - 16;
  tables_.sum_limit = power(q.n + q.m + 1);
  const std::size_t size = numbers.size() + 3;
  tables_.d.resize(size);
  for (auto* words :
       {&tables_.pp, &tables_.pq, &tables_.e1p, &tables_.e1q, &tables_.e2p, &tables_.e2q, &tables_.np, &tables_.nq, &tables_.r})
    words->resize(size);
  tables_.there.resize(size);
  const auto word = [](std::int64_t w) { return static_cast<std::int32_t>(w); };
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= triangles.size()) continue;
    const accelerated_triangle& t = triangles[numbers[i]];
    tables_.there[i] = 1;
    tables_.d[i] = static_cast<double>(t.d);
    tables_.pp[i] = word(t.pp);
    tables_.pq[i] = word(t.pq);
    tables_.e1p[i] = word(t.e1p);
    tables_.e1q[i] = word(t.e1q);
    tables_.e2p[i] = word(t.e2p);
    tables_.e2q[i] = word(t.e2q);
    tables_.np[i] = word(t.np);
    tables_.nq[i] = word(t.nq);
    tables_.r[i] = std::min(t.r & 3, 2);
  }
}

#if RTU_HAS_AVX2
namespace {

using reals = __m256d;
using words = __m128i;

RTU_AVX2_PART words read(const std::vector<std::int32_t>& from, std::size_t at) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(&from[at]));
}
RTU_AVX2_PART reals real(words w) { return _mm256_cvtepi32_pd(w); }
RTU_AVX2_PART words on_axis(words of_ray, words axis) { return _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(of_ray), axis)); }
/// floor(a b / 2^shift), which fits 32 bits.
RTU_AVX2_PART reals scaled(words a, words b, __m128i shift) {
  const __m256i product = _mm256_srl_epi64(_mm256_mul_epi32(_mm256_cvtepi32_epi64(a), _mm256_cvtepi32_epi64(b)), shift);
  return real(_mm256_castsi256_si128(_mm256_permutevar8x32_epi32(product, _mm256_setr_epi32(0, 2, 4, 6, 0, 0, 0, 0))));
}
RTU_AVX2_PART reals plus(reals a, reals b) { return _mm256_add_pd(a, b); }
RTU_AVX2_PART reals minus(reals a, reals b) { return _mm256_sub_pd(a, b); }
RTU_AVX2_PART reals times(reals a, reals b) { return _mm256_mul_pd(a, b); }
RTU_AVX2_PART reals all(double value) { return _mm256_set1_pd(value); }
RTU_AVX2_PART reals magnitude(reals x) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x); }
RTU_AVX2_PART reals negative(reals x) { return _mm256_xor_pd(_mm256_set1_pd(-0.0), x); }
RTU_AVX2_PART reals below(reals a, reals b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
RTU_AVX2_PART reals either(reals a, reals b) { return _mm256_or_pd(a, b); }
RTU_AVX2_PART reals outside(reals x, double least, double greatest) { return either(below(x, all(least)), below(all(greatest), x)); }
RTU_AVX2_PART unsigned bits(reals mask) { return static_cast<unsigned>(_mm256_movemask_pd(mask)); }

RTU_AVX2 triangle_lists::verdict tested(const triangle_lists::tables& all_of, const per_axis<std::int64_t>& position,
                                        const per_axis<std::int64_t>& direction, std::uint32_t first, std::uint32_t count) {
  const std::uint64_t asked = ~std::uint64_t{0} >> (64 - count);
  const std::int64_t grid = std::int64_t{1} << all_of.n, unit = std::int64_t{1} << (all_of.m - 1);
  for (unsigned i = 0; i < 3; ++i)
    if (position[i] < 0 || position[i] >= grid || direction[i] <= -unit || direction[i] >= unit) return {asked, 0, 0};

  const auto word = [](std::int64_t w) { return static_cast<int>(w); };
  const words from = _mm_setr_epi32(word(position[0]), word(position[1]), word(position[2]), 0);
  const words way = _mm_setr_epi32(word(direction[0]), word(direction[1]), word(direction[2]), 0);
  const words p_of_r = _mm_setr_epi32(1, 2, 0, 0), q_of_r = _mm_setr_epi32(2, 0, 1, 0);
  const words shift = _mm_cvtsi32_si128(static_cast<int>(all_of.m - 1));
  const auto s_end = static_cast<double>(2 * grid), den_end = static_cast<double>(unit), num_end = static_cast<double>(4 * grid);
  // As in `triangle_intersector::surely_misses`.
  const reals lost = all(4), rounding = all(0x1p-40), zero = _mm256_setzero_pd();

  triangle_lists::verdict v;
  for (std::uint32_t i = 0; i < count; i += 4) {
    const std::size_t at = first + i;
    const words r = read(all_of.r, at), p = on_axis(p_of_r, r), q = on_axis(q_of_r, r), np = read(all_of.np, at), nq = read(all_of.nq, at);
    const words o_p = on_axis(from, p), o_q = on_axis(from, q), d_p = on_axis(way, p), d_q = on_axis(way, q);
    const reals s = plus(real(on_axis(from, r)), plus(scaled(o_p, np, shift), scaled(o_q, nq, shift)));
    const reals den = plus(real(on_axis(way, r)), plus(scaled(d_p, np, shift), scaled(d_q, nq, shift)));
    const reals num = minus(_mm256_loadu_pd(&all_of.d[at]), s);
    const reals err =
        either(_mm256_xor_pd(below(num, zero), below(den, zero)),
               _mm256_cmp_pd(times(magnitude(num), all(all_of.num_scale)), times(magnitude(den), all(all_of.den_scale)), _CMP_GE_OQ));
    const reals wrapped = either(outside(s, -s_end, s_end - 1), outside(den, -den_end, den_end - 1));
    // What the registers would not hold, or the divider takes for 0.
    const reals odd = outside(num, 1 - num_end, num_end - 1);

    const reals t = _mm256_div_pd(num, den);  // in units of 2^(m-1) grid units
    const reals k_p = plus(minus(real(o_p), real(read(all_of.pp, at))), times(t, real(d_p)));
    const reals k_q = plus(minus(real(o_q), real(read(all_of.pq, at))), times(t, real(d_q)));
    const reals near = below(_mm256_max_pd(magnitude(k_p), magnitude(k_q)), all(all_of.k_limit));
    const reals e1p = real(read(all_of.e1p, at)), e1q = real(read(all_of.e1q, at)), e2p = real(read(all_of.e2p, at)),
                e2q = real(read(all_of.e2q, at));
    const reals a = times(e1p, k_q), b = times(e1q, k_p), c = times(e2q, k_p), e = times(e2p, k_q);
    const reals u = minus(a, b), w = minus(c, e), sum = plus(u, w);
    const reals u_off = plus(times(lost, plus(magnitude(e1p), magnitude(e1q))), times(rounding, plus(magnitude(a), magnitude(b))));
    const reals w_off = plus(times(lost, plus(magnitude(e2p), magnitude(e2q))), times(rounding, plus(magnitude(c), magnitude(e))));
    const reals off = plus(u_off, w_off);
    const reals beyond = _mm256_and_pd(below(plus(all(all_of.one), off), sum), below(sum, minus(all(all_of.sum_limit), off)));
    const reals missed = _mm256_and_pd(near, either(either(below(u, negative(u_off)), below(w, negative(w_off))), beyond));

    const unsigned here = count - i < 4 ? (1u << (count - i)) - 1 : 15;
    unsigned there = 0;
    for (unsigned k = 0; k < 4; ++k) there |= static_cast<unsigned>(all_of.there[at + k]) << k;
    const unsigned told = bits(either(err, missed)) & ~bits(odd) & there & here;
    v.open |= static_cast<std::uint64_t>(here & ~told) << i;
    v.errors += static_cast<unsigned>(__builtin_popcount(bits(err) & told));
    v.wrapped += static_cast<unsigned>(__builtin_popcount(bits(wrapped) & told));
  }
  return v;
}

}  // namespace

triangle_lists::verdict triangle_lists::operator()(const per_axis<std::int64_t>& position, const per_axis<std::int64_t>& direction,
                                                   std::uint32_t first, std::uint32_t count) const {
  return tested(tables_, position, direction, first, count);
}
#else
triangle_lists::verdict triangle_lists::operator()(const per_axis<std::int64_t>&, const per_axis<std::int64_t>&, std::uint32_t,
                                                   std::uint32_t count) const {
  return {~std::uint64_t{0} >> (64 - count), 0, 0};
}
#endif

}  // namespace rtusim
