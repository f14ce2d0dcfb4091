#include "modules/bih_core/bih_walk.h"

namespace rtusim {

bih_tables::bih_tables(const quantisation& widths, const bih_memory& memory)
    : address_bits(memory.address_bits),
      corner(memory.corner),
      // Then differences shifted up by 63 - n and reciprocals by n + 1 - C fit 64 bits; the upper half of their product is the distance.
      narrow(widths.n + widths.m <= 62 && widths.reciprocal_bits <= widths.n + 1),
      plane_shift(narrow ? 63 - widths.n : 0),
      reciprocal_shift(narrow ? widths.n + 1 - widths.reciprocal_bits : 0),
      nodes(memory.stack_address()),
      lists(memory.stack_address()) {
  for (std::uint32_t i = 0; i < memory.stack_address(); ++i) {
    node& to = nodes[i];
    to.axis = node_axis(memory.words[0][i]);
    to.pointer = static_cast<std::uint32_t>(node_pointer(memory.words[0][i]) & memory.address_mask());
    to.sibling = to.pointer ^ (to.pointer + 1);
    to.triangles = leaf_triangles(memory.words[1][i]);
    for (unsigned side = 0; side < 2; ++side) to.clip[side] = static_cast<std::int64_t>(memory.words[1 + side][i] << plane_shift);
    lists[i] = list_triangle(memory.words[3][i]);
  }
  for (std::uint32_t i = 0; i < bih_stack_words; ++i) {
    bih_words words;
    for (unsigned word = 0; word < 4; ++word) words[word] = memory.words[word][memory.stack_address() + i];
    stack[i] = unpack(words);
  }
}

bih_walk::bih_walk(const bih_core_params& p, std::shared_ptr<const bih_tables> tables)
    : params_(p), tables_(std::move(tables)), address_mask_((std::uint32_t{1} << p.address_bits) - 1), stack_(tables_->stack) {
  RTU_CHECK(tables_->address_bits, ==, p.address_bits);
}

std::uint32_t bih_walk::list_word(std::uint32_t address) const {
  const std::uint32_t first = address_mask_ + 1 - bih_stack_words;
  return address < first ? tables_->lists[address] : list_triangle(pack(stack_[address - first])[3]);
}

void bih_walk::expect(std::uint64_t clock, std::int64_t distance) {
  if (distance == no_hit || (!results_.empty() && results_.back().distance <= distance)) return;
  results_.push_back({clock + params_.result_latency_cycles, distance});
}

bih_kept bih_walk::kept() const {
  bih_kept k{registers(), {}};
  for (std::uint32_t i = 0; i < bih_stack_words; ++i) k.stack[i] = pack(stack_[i]);
  return k;
}

void bih_walk::inherit(const bih_kept& kept) {
  tmin_ = kept.tmin;
  tmax_ = kept.tmax;
  dist0_ = kept.dist0;
  dist1_ = kept.dist1;
  address3x_ = kept.address3x;
  address1x_ = kept.address1x;
  divider_clocks_ = kept.divider_clocks;
  for (std::uint32_t i = 0; i < bih_stack_words; ++i) stack_[i] = unpack(kept.stack[i]);
}

}  // namespace rtusim
