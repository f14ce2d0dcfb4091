#include "modules/svo_core/svo_lanes.h"

#if RTU_HAS_AVX2

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rtusim {
namespace {

constexpr std::size_t lanes = 8;

/// Eight 32-bit words, one a ray. A mask has all bits of a lane alike.
using words = __m256i;
/// One value an axis.
struct vectors {
  words x, y, z;
};

RTU_AVX2_PART words all(int value) { return _mm256_set1_epi32(value); }
RTU_AVX2_PART words zeros() { return _mm256_setzero_si256(); }
RTU_AVX2_PART words both(words a, words b) { return _mm256_and_si256(a, b); }
RTU_AVX2_PART words either(words a, words b) { return _mm256_or_si256(a, b); }
RTU_AVX2_PART words but_not(words a, words b) { return _mm256_andnot_si256(b, a); }
RTU_AVX2_PART words plus(words a, words b) { return _mm256_add_epi32(a, b); }
/// Counts where a mask holds: it is -1 there.
RTU_AVX2_PART words counted_up(words count, words mask) { return _mm256_sub_epi32(count, mask); }
RTU_AVX2_PART words least(words a, words b) { return _mm256_min_epi32(a, b); }
RTU_AVX2_PART words greatest(words a, words b) { return _mm256_max_epi32(a, b); }
RTU_AVX2_PART words least(const vectors& v) { return least(v.x, least(v.y, v.z)); }
RTU_AVX2_PART words greatest(const vectors& v) { return greatest(v.x, greatest(v.y, v.z)); }
RTU_AVX2_PART words above(words a, words b) { return _mm256_cmpgt_epi32(a, b); }
RTU_AVX2_PART words equal(words a, words b) { return _mm256_cmpeq_epi32(a, b); }
RTU_AVX2_PART words where(words mask, words yes, words no) { return _mm256_blendv_epi8(no, yes, mask); }
RTU_AVX2_PART vectors where(words mask, const vectors& yes, const vectors& no) {
  return {where(mask, yes.x, no.x), where(mask, yes.y, no.y), where(mask, yes.z, no.z)};
}
RTU_AVX2_PART unsigned bits(words mask) { return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(mask))); }
RTU_AVX2_PART bool any(words mask) { return _mm256_testz_si256(mask, mask) == 0; }
RTU_AVX2_PART words read(const void* from) { return _mm256_loadu_si256(static_cast<const __m256i*>(from)); }
RTU_AVX2_PART void write(void* to, words w) { _mm256_storeu_si256(static_cast<__m256i*>(to), w); }
/// A mask of the bits that are set in `set`; `bit` has one.
RTU_AVX2_PART words holds(words set, words bit) { return equal(both(set, bit), bit); }
/// A mask of one bit of each word.
RTU_AVX2_PART words mask_of_bit(words w, words bit) { return _mm256_srai_epi32(_mm256_sllv_epi32(w, _mm256_sub_epi32(all(31), bit)), 31); }

/// Rows become columns.
RTU_AVX2_PART void transpose(words (&r)[8]) {
  words pairs[8], quads[8];
  for (int i = 0; i < 8; i += 2) {
    pairs[i] = _mm256_unpacklo_epi32(r[i], r[i + 1]);
    pairs[i + 1] = _mm256_unpackhi_epi32(r[i], r[i + 1]);
  }
  for (int i = 0; i < 8; i += 4) {
    quads[i] = _mm256_unpacklo_epi64(pairs[i], pairs[i + 2]);
    quads[i + 1] = _mm256_unpackhi_epi64(pairs[i], pairs[i + 2]);
    quads[i + 2] = _mm256_unpacklo_epi64(pairs[i + 1], pairs[i + 3]);
    quads[i + 3] = _mm256_unpackhi_epi64(pairs[i + 1], pairs[i + 3]);
  }
  for (int i = 0; i < 4; ++i) {
    r[i] = _mm256_permute2x128_si256(quads[i], quads[i + 4], 0x20);
    r[i + 4] = _mm256_permute2x128_si256(quads[i], quads[i + 4], 0x31);
  }
}

/// Bit 0, 1 or 2: the axis of the largest, the first of equals.
RTU_AVX2_PART words largest(const vectors& v) {
  const words behind_x = either(above(v.y, v.x), above(v.z, v.x));
  return where(behind_x, where(above(v.z, v.y), all(4), all(2)), all(1));
}
/// The same of the smallest.
RTU_AVX2_PART words smallest(const vectors& v) {
  const words behind_x = either(above(v.x, v.y), above(v.x, v.z));
  return where(behind_x, where(above(v.y, v.z), all(4), all(2)), all(1));
}
RTU_AVX2_PART words where_negative(words sign, words yes, words no) {
  return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(no), _mm256_castsi256_ps(yes), _mm256_castsi256_ps(sign)));
}
/// By the bits of the child.
RTU_AVX2_PART vectors by_half(words child, const vectors& upper, const vectors& lower) {
  return {where_negative(_mm256_slli_epi32(child, 31), upper.x, lower.x), where_negative(_mm256_slli_epi32(child, 30), upper.y, lower.y),
          where_negative(_mm256_slli_epi32(child, 29), upper.z, lower.z)};
}
/// The child that a ray enters first.
RTU_AVX2_PART words first_child(const vectors& t0, const vectors& tm) {
  const words in = greatest(t0);
  const words lower = either(both(above(tm.x, in), all(1)), either(both(above(tm.y, in), all(2)), both(above(tm.z, in), all(4))));
  return but_not(all(7), either(lower, largest(t0)));
}
/// Bits that are set, of words below 256.
RTU_AVX2_PART words ones(words w) {
  const words of_nibble = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const words low = both(w, all(15)), high = _mm256_srli_epi32(w, 4);
  return plus(_mm256_shuffle_epi8(of_nibble, low), both(_mm256_shuffle_epi8(of_nibble, high), all(255)));
}

template <bool Wrap>
RTU_AVX2_PART words middle(words a, words b, __m128i up) {
  if constexpr (Wrap) return _mm256_srai_epi32(_mm256_sra_epi32(_mm256_sll_epi32(plus(a, b), up), up), 1);
  return plus(both(a, b), _mm256_srai_epi32(_mm256_xor_si256(a, b), 1));
}

/// The rays of a batch that meet the root cube.
struct entering {
  std::size_t count = 0;
  std::uint32_t job[lane_batch + lanes];
  std::int32_t fields[8][lane_batch + lanes];  // those of a job packet, converted
};

/// Converts words as the converter does; those at the ends of its range it does itself.
struct lane_converter {
  const lane_setup& with;
  words first, last;  // biased exponents between which a word keeps some of its value
  __m256 one;

  RTU_AVX2 explicit lane_converter(const lane_setup& s) : with(s) {
    first = all(static_cast<int>(s.converter.least_exponent()));
    last = all(static_cast<int>(s.converter.greatest_exponent()));
    one = _mm256_set1_ps(std::ldexp(1.0f, static_cast<int>(s.core.format.fraction_bits)));
  }
  RTU_AVX2_PART words operator()(words floats, unsigned used, numeric::float_to_fixed_stats& counted) const {
    const words biased = both(_mm256_srli_epi32(floats, 23), all(255));
    words fixed = _mm256_cvttps_epi32(_mm256_mul_ps(_mm256_castsi256_ps(floats), one));
    if (with.conversion.odd_exponent_lsb) {
      const words lost = both(both(fixed, all(1)), but_not(above(biased, all(127)), biased));
      fixed = _mm256_sub_epi32(fixed, _mm256_sign_epi32(lost, either(floats, all(1))));
    }
    if (unsigned ends = bits(either(above(biased, last), above(first, biased))) & used; ends != 0) {
      alignas(32) std::uint32_t word[lanes];
      alignas(32) std::int32_t value[lanes];
      write(word, floats);
      write(value, fixed);
      for (; ends != 0; ends &= ends - 1) {
        const auto k = static_cast<unsigned>(__builtin_ctz(ends));
        value[k] = static_cast<std::int32_t>(with.converter(word[k], counted));
      }
      fixed = read(value);
    }
    return fixed;
  }
};

/// Converts the jobs, settles those that miss the root cube and lists the others.
RTU_AVX2 void enter(const lane_setup& with, const job_packet* jobs, std::size_t count, svo_walked* to,
                    numeric::float_to_fixed_stats& counted, entering& list) {
  const lane_converter convert(with);
  for (std::size_t i = 0; i < count; i += lanes) {
    const std::size_t here = std::min(lanes, count - i);
    const unsigned used = (1u << here) - 1;
    words f[8];
    for (std::size_t k = 0; k < lanes; ++k) f[k] = read(&jobs[i + std::min(k, here - 1)]);
    transpose(f);
    for (unsigned k = 1; k < 7; ++k) f[k] = convert(f[k], used, counted);
    const words in = greatest(vectors{f[1], f[2], f[3]}), out = least(vectors{f[4], f[5], f[6]});
    unsigned meet = bits(above(out, in)) & used;
    if (!with.core.negative_t) meet &= bits(above(out, zeros()));
    for (std::size_t k = 0; k < here; ++k) to[i + k] = {0, jobs[i + k].job_word, 2, 0, 0, no_axis, false, false};
    if (meet == 0) continue;
    alignas(32) std::int32_t fields[8][lanes];
    for (unsigned k = 0; k < 8; ++k) write(fields[k], f[k]);
    for (; meet != 0; meet &= meet - 1) {
      const auto k = static_cast<unsigned>(__builtin_ctz(meet));
      list.job[list.count] = static_cast<std::uint32_t>(i) + k;
      for (unsigned field = 0; field < 8; ++field) list.fields[field][list.count] = fields[field][k];
      ++list.count;
    }
  }
  counted.conversions += 6 * count;
}

/// Walks eight rays of the list, or as many as are left, from `first` on. `Wrap` and `Behind` as in `svo_walk`.
template <bool Wrap, bool Behind>
RTU_AVX2 void walk(const lane_setup& with, const entering& list, std::size_t first, svo_walked* to) {
  const word_view& octree = with.octree;
  const __m128i up = _mm_cvtsi32_si128(static_cast<int>(32 - with.core.format.width()));
  const words one = all(1), zero = zeros(), size = all(static_cast<int>(octree.size)), mask = all(static_cast<int>(octree.address_mask));
  const words full = all(static_cast<int>(with.core.stack_depth));
  const auto word_at = [&](words entry) RTU_AVX2 {
    const words place = both(entry, mask);
    return _mm256_mask_i32gather_epi32(zero, reinterpret_cast<const int*>(octree.data), place, above(size, place), 4);
  };
  const auto middles = [&](const vectors& a, const vectors& b) RTU_AVX2 {
    return vectors{middle<Wrap>(a.x, b.x, up), middle<Wrap>(a.y, b.y, up), middle<Wrap>(a.z, b.z, up)};
  };
  const auto field = [&](unsigned k) RTU_AVX2 { return read(&list.fields[k][first]); };
  const auto count = static_cast<int>(std::min(lanes, list.count - first));

  // A frame of each ray: t0, t1, entry and child. What follows from them is not kept.
  alignas(32) std::int32_t stack[most_stack_frames + 1][lanes][8];
  const words mirrored = both(_mm256_srli_epi32(field(0), static_cast<int>(job_id_bits)), all(7));
  vectors t0{field(1), field(2), field(3)}, t1{field(4), field(5), field(6)}, tm = middles(t0, t1);
  words entry = field(7), word = word_at(entry), child = first_child(t0, tm);
  vectors c0 = by_half(child, tm, t0), c1 = by_half(child, t1, tm);  // the child's entry and exit
  words cost = all(2), pushes = zero, depth = zero, hit = zero, overflow = zero, t_hit = zero, axis = zero;
  words active = above(all(count), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));

  while (any(active)) {
    // EVAL
    const words exit = smallest(c1);
    const words slot = _mm256_xor_si256(child, mirrored);
    words filled = both(mask_of_bit(word, plus(slot, all(8))), active);
    if constexpr (!Behind) filled = both(filled, above(least(c1), zero));
    const words leaf = both(mask_of_bit(word, slot), filled);
    words push = but_not(filled, leaf);
    const words onward = but_not(active, filled);
    if (any(leaf)) {
      words t = greatest(c0);
      if constexpr (!Behind) t = greatest(t, zero);
      t_hit = where(leaf, t, t_hit);
      axis = where(leaf, largest(c0), axis);
      hit = either(hit, leaf);
      active = but_not(active, leaf);
    }
    // NEXT: to the child beyond, or out of the cube
    const words leaving = both(onward, holds(child, exit));
    const words moving = but_not(onward, leaving);
    cost = counted_up(counted_up(cost, onward), moving);
    const words step = both(moving, exit);

    if (any(push)) {
      const words over = both(push, equal(depth, full));
      overflow = either(overflow, over);
      active = but_not(active, over);
      push = but_not(push, over);
      // What the others keep there is beyond their stacks' ends.
      words frames[8] = {t0.x, t0.y, t0.z, t1.x, t1.y, t1.z, entry, child};
      transpose(frames);
      alignas(32) std::int32_t at[lanes];
      write(at, depth);
      for (unsigned k = 0; k < lanes; ++k) write(stack[at[k]][k], frames[k]);
      cost = plus(cost, both(push, all(3)));  // PUSH, and INIT and EVAL of the child
      pushes = counted_up(pushes, push);
      depth = counted_up(depth, push);
      words offset = both(_mm256_srli_epi32(word, 16), all(0x7fff)), counted = word;
      const words far = both(_mm256_srai_epi32(word, 31), push);
      if (any(far)) {
        const words behind = word_at(plus(entry, offset));
        offset = where(far, behind, offset);
        if (with.core.far_popcount) counted = where(far, behind, counted);
      }
      const words nodes = but_not(both(_mm256_srli_epi32(counted, 8), all(255)), counted);
      const words before = _mm256_sub_epi32(_mm256_sllv_epi32(one, slot), one);
      entry = where(push, plus(plus(entry, offset), ones(both(nodes, before))), entry);
      t0 = where(push, c0, t0);
      t1 = where(push, c1, t1);
      tm = middles(t0, t1);
      word = word_at(entry);
      child = where(push, first_child(t0, tm), child);
    }
    child = either(child, step);

    if (any(leaving)) {
      words pop = leaving;
      for (;;) {
        const words bottom = both(pop, equal(depth, zero));
        active = but_not(active, bottom);
        pop = but_not(pop, bottom);
        if (!any(pop)) break;
        depth = plus(depth, pop);
        alignas(32) std::int32_t at[lanes];
        write(at, depth);
        words frames[8];
        for (unsigned k = 0; k < lanes; ++k) frames[k] = read(stack[at[k]][k]);
        transpose(frames);
        t0 = where(pop, {frames[0], frames[1], frames[2]}, t0);
        t1 = where(pop, {frames[3], frames[4], frames[5]}, t1);
        entry = where(pop, frames[6], entry);
        child = where(pop, frames[7], child);
        tm = middles(t0, t1);
        cost = plus(cost, both(pop, all(2)));  // POP and NEXT
        const words out = smallest(by_half(child, t1, tm));
        const words further = both(pop, holds(child, out));
        const words back = but_not(pop, further);
        cost = counted_up(cost, back);
        child = either(child, both(back, out));
        pop = further;
      }
      word = word_at(entry);
    }
    c0 = by_half(child, tm, t0);
    c1 = by_half(child, t1, tm);
  }
  alignas(32) std::int32_t s[7][lanes];
  const words told[7] = {t_hit, cost, pushes, depth, axis, hit, overflow};
  for (unsigned k = 0; k < 7; ++k) write(s[k], told[k]);
  for (int k = 0; k < count; ++k) {
    svo_walked& w = to[list.job[first + static_cast<std::size_t>(k)]];
    w.t_hit = s[0][k];
    w.cost = static_cast<std::uint32_t>(s[1][k]);
    w.pushes = static_cast<std::uint32_t>(s[2][k]);
    w.depth = static_cast<std::uint8_t>(s[3][k]);
    w.hit = s[5][k] != 0;
    w.axis = w.hit ? static_cast<std::int8_t>(s[4][k] >> 1) : no_axis;
    w.overflow = s[6][k] != 0;
  }
}

template <bool Wrap, bool Behind>
void walk_all(const lane_setup& with, const entering& list, svo_walked* to) {
  for (std::size_t i = 0; i < list.count; i += lanes) walk<Wrap, Behind>(with, list, i, to);
}

}  // namespace

void walk_in_lanes(const lane_setup& with, const job_packet* jobs, std::size_t count, svo_walked* to,
                   numeric::float_to_fixed_stats& counted) {
  entering list;
  enter(with, jobs, count, to, counted, list);
  if (with.core.tm_wrap)
    with.core.negative_t ? walk_all<true, true>(with, list, to) : walk_all<true, false>(with, list, to);
  else
    with.core.negative_t ? walk_all<false, true>(with, list, to) : walk_all<false, false>(with, list, to);
}

}  // namespace rtusim

#endif
