#include "testbench/tests/random_bih.h"

#include "modules/config/error.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim::test {
namespace {

std::uint64_t word_of(rng& random) { return std::uint64_t{random()} << 32 | random(); }

/// Words whose children lie behind their parent, so that nothing loops.
bih_memory random_words(rng& random, const bih_core_params& p) {
  bih_memory memory(p.address_bits);
  const std::uint32_t end = memory.stack_address();
  const bool ladder = random() % 3 == 0, odd = random() % 3 == 0;
  const std::uint32_t used = 2 + random() % (end - 1);
  const std::uint64_t grid = (std::uint64_t{1} << p.widths.n) - 1;
  for (std::uint32_t i = 0; i < end; ++i) {
    for (auto& words : memory.words) words[i] = odd ? word_of(random) & greatest_bih_word : 0;
    memory.words[3][i] = word_of(random) & greatest_bih_word;
    const std::uint32_t last = std::min(end, used) - 2;
    // On a ladder each second node is a leaf, else pairs follow as in a heap, but for some that are shared.
    std::uint32_t left = ladder ? i + 1 : 2 * i + 1;
    if (!ladder && random() % 16 == 0) left = i + 1 + random() % 16;
    bih_words node;
    if (left <= last && (ladder ? (i + 1) % 2 == 0 || i == 0 : random() % 8 != 0)) {
      node = make_inner(random() % 3, left, 0, 0);
      const bool both = ladder ? random() % 16 != 0 : random() % 4 == 0;
      node[1] = both ? grid : word_of(random) & grid;
      node[2] = both ? 0 : word_of(random) & grid;
      if (odd && random() % 8 == 0) node[1 + random() % 2] = word_of(random) & greatest_bih_word;
    } else {
      const std::uint32_t triangles = random() % 8 == 0 ? random() % 40 : 1 + random() % 4;
      const std::uint32_t first = odd ? random() & memory.address_mask() : random() % (end - triangles % end);
      node = make_leaf(first, triangles == 0 && p.empty_leaf_hangs ? 1 : triangles);
    }
    for (unsigned w = 0; w < 3; ++w) memory.words[w][i] = node[w];
  }
  for (std::uint32_t i = end; i <= memory.address_mask(); ++i)
    for (auto& words : memory.words) words[i] = word_of(random) & greatest_bih_word;
  for (std::int64_t& c : memory.corner) c = static_cast<std::int64_t>(random() % 4 == 0 ? grid : word_of(random) & grid);
  return memory;
}

}  // namespace

bih_core_params bih_as_built() {
  bih_core_params p;
  p.address_bits = 10;
  p.exit_at_zero = p.box_never_misses = p.stack_wraps = p.empty_leaf_hangs = true;
  return p;
}

bih_core_params random_bih_core(rng& random) {
  bih_core_params p;
  const auto coin = [&random] { return random() % 2 == 0; };
  p.address_bits = 6 + random() % 4;
  p.exit_at_zero = coin();
  p.box_never_misses = coin();
  p.stack_wraps = coin();
  p.empty_leaf_hangs = coin();
  p.early_out = coin();
  p.result_latency_cycles = 1 + random() % 60;
  if (coin()) {
    p.widths.n = 4 + random() % 29;
    p.widths.m = 4 + random() % 31;
    p.widths.reciprocal_bits = random() % 29;
  }
  return p;
}

bih_memory random_bih(rng& random, const bih_core_params& p) {
  for (;;) {
    bih_memory memory = random_words(random, p);
    try {
      if (check_bih(memory, "random", {true, p.empty_leaf_hangs}).most_cycles <= 100'000) return memory;
    } catch (const input_error&) {
      // Too many shared subtrees.
    }
  }
}

quantised_ray random_ray(rng& random, const bih_core_params& p) {
  quantised_ray ray;
  const unsigned width = p.widths.m + p.widths.reciprocal_bits;
  for (unsigned i = 0; i < 3; ++i) {
    ray.position[i] = static_cast<std::int64_t>(word_of(random) & ((std::uint64_t{1} << p.widths.n) - 1));
    if (random() % 8 == 0) ray.position[i] = 0;
    ray.reciprocal[i] = numeric::wrap(static_cast<std::int64_t>(word_of(random)), 1 + random() % width);
    if (random() % 8 == 0) ray.reciprocal[i] = (std::int64_t{1} << (width - 1)) - 1;
  }
  return ray;
}

}  // namespace rtusim::test
