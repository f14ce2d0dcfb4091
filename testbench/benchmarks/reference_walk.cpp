#include "testbench/benchmarks/reference_walk.h"

#include "modules/formats/svo_word.h"

namespace rtusim {
namespace {

struct vec {
  std::int32_t x, y, z;
};
struct frame {
  std::uint32_t entry;
  unsigned child;
  vec t0, tm, t1;
};

std::int32_t middle(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b)) >> 1;
}
vec middle(const vec& a, const vec& b) { return {middle(a.x, b.x), middle(a.y, b.y), middle(a.z, b.z)}; }
vec select(unsigned child, const vec& low, const vec& high) {
  return {child & 1 ? high.x : low.x, child & 2 ? high.y : low.y, child & 4 ? high.z : low.z};
}

unsigned first_child(const frame& f) {
  if (f.t0.x >= f.t0.y && f.t0.x >= f.t0.z) return (f.t0.x >= f.tm.y ? 2u : 0u) | (f.t0.x >= f.tm.z ? 4u : 0u);
  if (f.t0.y >= f.t0.z) return (f.t0.y >= f.tm.x ? 1u : 0u) | (f.t0.y >= f.tm.z ? 4u : 0u);
  return (f.t0.z >= f.tm.x ? 1u : 0u) | (f.t0.z >= f.tm.y ? 2u : 0u);
}

}  // namespace

reference_outcome reference_walk(const traversal_job& job, const word_view& memory) {
  const unsigned a = job.direction_bits();
  const auto narrow = [](const per_axis<std::int64_t>& v) {
    return vec{static_cast<std::int32_t>(v[0]), static_cast<std::int32_t>(v[1]), static_cast<std::int32_t>(v[2])};
  };
  frame stack[12];
  unsigned depth = 0;
  frame f{job.address, 0, narrow(job.t0), {}, narrow(job.t1)};
  f.tm = middle(f.t0, f.t1);
  const std::int32_t enter = std::max(f.t0.x, std::max(f.t0.y, f.t0.z));
  const std::int32_t leave = std::min(f.t1.x, std::min(f.t1.y, f.t1.z));
  if (enter >= leave) return {false, 0, -1, 2};
  std::uint32_t cost = 1;
  f.child = first_child(f);
  for (;;) {
    ++cost;  // EVAL
    const std::uint32_t word = memory[f.entry];
    const unsigned slot = f.child ^ a;
    if (is_valid(word, slot)) {
      const vec t0 = select(f.child, f.t0, f.tm);
      if (is_leaf(word, slot)) {
        if (t0.x >= t0.y && t0.x >= t0.z) return {true, t0.x, 0, cost};
        if (t0.y >= t0.z) return {true, t0.y, 1, cost};
        return {true, t0.z, 2, cost};
      }
      const vec t1 = select(f.child, f.tm, f.t1);
      std::uint32_t offset = child_pointer(word);
      std::uint32_t counted = word;
      if (is_far(word)) counted = offset = memory[f.entry + offset];
      stack[depth++] = f;
      f = {f.entry + offset + child_nodes_before(counted, slot), 0, t0, middle(t0, t1), t1};
      f.child = first_child(f);
      cost += 2;  // PUSH, INIT
      continue;
    }
    for (;;) {
      ++cost;  // NEXT
      const vec t1 = select(f.child, f.tm, f.t1);
      const unsigned bit = t1.x <= t1.y && t1.x <= t1.z ? 1 : t1.y <= t1.z ? 2 : 4;
      if ((f.child & bit) == 0) {
        f.child |= bit;
        break;
      }
      if (depth == 0) return {false, 0, -1, cost};
      f = stack[--depth];
      ++cost;  // POP
    }
  }
}

}  // namespace rtusim
