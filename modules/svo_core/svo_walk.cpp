#include "modules/svo_core/svo_walk.h"

#include <algorithm>
#include <type_traits>

#include "modules/formats/svo_word.h"

namespace rtusim {
namespace {

template <class Int>
struct walk_frame {
  Int t0[3], tm[3], t1[3];
  std::uint32_t entry;
  std::uint32_t word;
  std::uint32_t child;
};

template <class Int>
unsigned largest(const Int* v) {
  return v[0] >= v[1] && v[0] >= v[2] ? 0 : v[1] >= v[2] ? 1 : 2;
}
template <class Int>
unsigned smallest(const Int* v) {
  return v[0] <= v[1] && v[0] <= v[2] ? 0 : v[1] <= v[2] ? 1 : 2;
}

/// `Int` holds the fixed-point word; `Wrap` is the erratum tm_wrap, `Behind` the erratum negative_t. `Cube`: the cube that is hit is
/// wanted.
template <class Int, bool Wrap, bool Behind, bool Cube>
svo_outcome walk(const traversal_job& job, const word_view& memory, const svo_core_params& p, svo_cube* cube) {
  using Unsigned = std::make_unsigned_t<Int>;
  const unsigned width = p.format.width();
  const auto middle = [width](Int a, Int b) {
    if constexpr (Wrap)
      return numeric::wrapped_midpoint<Int, Unsigned>(a, b, width);
    else
      return numeric::midpoint<Int>(a, b);
  };

  svo_outcome o;
  o.job_word = job.job_word;
  o.entry = job.address;
  walk_frame<Int> stack[most_stack_frames + 1];
  walk_frame<Int>* f = stack;
  for (unsigned i = 0; i < 3; ++i) {
    f->t0[i] = static_cast<Int>(job.t0[i]);
    f->t1[i] = static_cast<Int>(job.t1[i]);
    f->tm[i] = middle(f->t0[i], f->t1[i]);
  }
  const auto set_child = [&o](const walk_frame<Int>& top) {
    const unsigned m = largest(top.t0);
    const Int entry = top.t0[m];
    const unsigned all = static_cast<unsigned>(entry >= top.tm[0]) | static_cast<unsigned>(entry >= top.tm[1]) << 1 |
                         static_cast<unsigned>(entry >= top.tm[2]) << 2;
    o.child = static_cast<std::uint8_t>(all & ~(1u << m));
  };
  {
    const Int exit = f->t1[smallest(f->t1)];
    if (f->t0[largest(f->t0)] >= exit || (!Behind && exit <= 0)) {
      set_child(*f);
      o.cost = 2;
      return o;
    }
  }

  const unsigned a = job.direction_bits();
  const walk_frame<Int>* const full = stack + p.stack_depth;
  std::uint32_t cost = 0;
  std::uint32_t entry = job.address;
  std::uint32_t word = 0;
  unsigned child = 0;
  Int c0[3], c1[3];  // the child's entry and exit parameters

init:
  cost += 2;  // INIT and the EVAL after it
  word = memory[entry];
  {
    const unsigned m = largest(f->t0);
    const Int in = f->t0[m];
    child =
        (static_cast<unsigned>(in >= f->tm[0]) | static_cast<unsigned>(in >= f->tm[1]) << 1 | static_cast<unsigned>(in >= f->tm[2]) << 2) &
        ~(1u << m);
    for (unsigned i = 0; i < 3; ++i) {
      const bool upper = child >> i & 1;
      c0[i] = upper ? f->tm[i] : f->t0[i];
      c1[i] = upper ? f->t1[i] : f->tm[i];
    }
  }

eval : {
  const unsigned m = smallest(c1);
  const unsigned slot = child ^ a;
  if ((word >> (8 + slot) & 1) != 0 && (Behind || c1[m] > 0)) {
    if (word >> slot & 1) {
      const unsigned axis = largest(c0);
      o.hit = true;
      o.t_hit = Behind ? c0[axis] : std::max<Int>(c0[axis], 0);
      o.axis = static_cast<std::int8_t>(axis);
      goto done;
    }
    // PUSH
    if (f == full) {
      o.overflow = true;
      goto done;
    }
    ++cost;
    ++o.pushes;
    f->entry = entry;
    f->word = word;
    f->child = child;
    std::uint32_t counted = word;
    std::uint32_t offset = child_pointer(word);
    if (is_far(word)) {
      offset = memory[entry + offset];
      if (p.far_popcount) counted = offset;
    }
    entry += offset + child_nodes_before(counted, slot);
    ++f;
    for (unsigned i = 0; i < 3; ++i) {
      f->t0[i] = c0[i];
      f->t1[i] = c1[i];
      f->tm[i] = middle(c0[i], c1[i]);
    }
    goto init;
  }

  // NEXT
  ++cost;
  if ((child >> m & 1) == 0) {
    child |= 1u << m;
    c0[m] = f->tm[m];
    c1[m] = f->t1[m];
    ++cost;
    goto eval;
  }
}

  // The ray leaves the cube; so it may leave the cube around that, and so on.
  for (;;) {
    if (f == stack) goto done;
    --f;
    cost += 2;  // POP and NEXT
    child = f->child;
    for (unsigned i = 0; i < 3; ++i) c1[i] = child >> i & 1 ? f->t1[i] : f->tm[i];
    const unsigned m = smallest(c1);
    if ((child >> m & 1) == 0) {
      child |= 1u << m;
      c1[m] = f->t1[m];
      for (unsigned i = 0; i < 3; ++i) c0[i] = child >> i & 1 ? f->tm[i] : f->t0[i];
      entry = f->entry;
      word = f->word;
      ++cost;
      goto eval;
    }
    entry = f->entry;
  }

done:
  if constexpr (Cube) {
    if (o.hit) {
      *cube = {};
      const auto descend = [&](unsigned child_of_level) {
        ++cube->levels;
        for (unsigned i = 0; i < 3; ++i) cube->place[i] = cube->place[i] << 1 | ((child_of_level ^ a) >> i & 1);
      };
      for (const walk_frame<Int>* level = stack; level != f; ++level) descend(level->child);
      descend(child);
    }
  }
  o.cost = cost;
  o.entry = entry;
  o.child = static_cast<std::uint8_t>(child);
  o.depth = static_cast<std::uint8_t>(f - stack);
  return o;
}

template <class Int, bool Cube>
auto choose(const svo_core_params& p) {
  if (p.tm_wrap) return p.negative_t ? &walk<Int, true, true, Cube> : &walk<Int, true, false, Cube>;
  return p.negative_t ? &walk<Int, false, true, Cube> : &walk<Int, false, false, Cube>;
}

template <bool Cube>
auto choose(const svo_core_params& p) {
  return p.format.width() <= 32 ? choose<std::int32_t, Cube>(p) : choose<std::int64_t, Cube>(p);
}

}  // namespace

svo_walk::svo_walk(const svo_core_params& p) : params_(p), walk_(choose<false>(p)), walk_to_cube_(choose<true>(p)) {}

}  // namespace rtusim
