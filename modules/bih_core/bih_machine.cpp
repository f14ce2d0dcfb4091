#include "modules/bih_core/bih_machine.h"

#include <algorithm>

#include "modules/numeric/fixed_point.h"
#include "modules/numeric/plane_distance.h"

namespace rtusim {

bih_machine::bih_machine(const bih_core_params& p, const bih_memory& memory) : params_(p), memory_(&memory) {
  RTU_CHECK(memory.address_bits, ==, p.address_bits);
  for (unsigned w = 0; w < 4; ++w)
    for (std::uint32_t i = 0; i < bih_stack_words; ++i) stack_[i][w] = memory.words[w][memory.stack_address() + i];
  settle();
}

std::uint64_t bih_machine::word(unsigned which, std::uint32_t address) const {
  const std::uint32_t first = memory_->stack_address();
  return address < first ? memory_->words[which][address] : stack_[address - first][which];
}

bih_words bih_machine::words() const {
  return {word(0, now_.address3x), word(1, now_.address3x), word(2, now_.address3x), word(3, now_.address1x)};
}

std::uint32_t bih_machine::stack_entry(unsigned stack_pos) const { return memory_->stack_address() + stack_pos; }

std::int64_t bih_machine::distance_to(std::uint64_t plane, unsigned axis) const {
  const unsigned n = params_.widths.n;
  const std::int64_t position = ray_.position[axis] & ((std::int64_t{1} << n) - 1);
  const std::int64_t difference = numeric::wrap(static_cast<std::int64_t>(plane) - position, n + 1);
  return numeric::plane_distance(difference, ray_.reciprocal[axis], params_.widths.reciprocal_bits);
}

void bih_machine::start(const quantised_ray& ray) {
  RTU_CHECK(static_cast<int>(now_.state), ==, static_cast<int>(bih_state::aabb));
  RTU_CHECK(busy_, ==, false);
  ray_ = ray;
  busy_ = true;
  outcome_ = {};
  results_.clear();
  nearest_ = no_hit;
  settle();
}

void bih_machine::result(std::int64_t distance) {
  RTU_CHECK(out_.tri_en, ==, true);
  if (distance != no_hit) results_.emplace_back(clock_ + params_.result_latency_cycles, distance);
}

void bih_machine::step() {
  if (outcome_.overflow) return;
  if (busy_) {
    bih_visits& v = outcome_.visits;
    switch (now_.state) {
      case bih_state::aabb: ++v.aabb; break;
      case bih_state::node: ++v.node; break;
      case bih_state::inner: ++v.inner; break;
      case bih_state::push: ++v.push; break;
      case bih_state::pop: ++v.pop; break;
      case bih_state::leaf: ++v.leaf; break;
    }
    outcome_.triangles += out_.tri_en;
    outcome_.max_stack = std::max<std::uint32_t>(outcome_.max_stack, next_.stack_pos);
    if (out_.we) stack_[now_.stack_pos] = pushed_;
    busy_ = !out_.done;
  }
  divider_clocks_ = out_.tri_en ? params_.triangle_interval_cycles - 1 : divider_clocks_ - std::min<std::uint64_t>(divider_clocks_, 1);
  next_.address3x = out_.addr3x;
  next_.address1x = out_.addr1x;
  now_ = next_;
  ++clock_;
  settle();
}

void bih_machine::settle() {
  for (; !results_.empty() && results_.front().first <= clock_; results_.pop_front())
    nearest_ = std::min(nearest_, results_.front().second);
  next_ = now_;
  out_ = {};
  out_.tri_num = list_triangle(word(3, now_.address1x));
  out_.addr3x = now_.address3x;
  out_.addr1x = now_.address1x;
  switch (now_.state) {
    case bih_state::aabb: settle_aabb(); break;
    case bih_state::node: settle_node(); break;
    case bih_state::inner: settle_inner(); break;
    case bih_state::push:
      out_.addr3x = now_.near_child;
      next_.state = bih_state::node;
      break;
    case bih_state::pop: settle_pop(); break;
    case bih_state::leaf: settle_leaf(); break;
  }
}

void bih_machine::settle_aabb() {
  out_.addr3x = 0;
  out_.addr1x = 0;
  if (!busy_) return;
  const bih_interval inside = box_interval(ray_, memory_->corner, params_);
  next_.tmin = inside.tmin;
  next_.tmax = inside.tmax;
  next_.stack_pos = 0;
  out_.done = inside.missed;
  if (!inside.missed) next_.state = bih_state::node;
}

void bih_machine::settle_node() {
  const bih_words w = words();
  const unsigned axis = node_axis(w[0]);
  if (axis == bih_leaf) {
    const auto first = static_cast<std::uint32_t>(node_pointer(w[0]) & memory_->address_mask());
    out_.addr1x = first;
    next_.next_triangle = (first + 1) & memory_->address_mask();
    next_.triangles_left = leaf_triangles(w[1]);
    next_.state = bih_state::leaf;
    return;
  }
  const bool down = ray_.reciprocal[axis] < 0;
  next_.dist0 = distance_to(w[down ? 2 : 1], axis);
  next_.dist1 = distance_to(w[down ? 1 : 2], axis);
  next_.state = bih_state::inner;
}

void bih_machine::settle_inner() {
  const std::uint64_t word0 = word(0, now_.address3x);  // still the node's
  const auto left = static_cast<std::uint32_t>(node_pointer(word0) & memory_->address_mask());
  const auto right = (left + 1) & memory_->address_mask();
  const bool down = ray_.reciprocal[node_axis(word0)] < 0;
  const std::uint32_t near_child = down ? right : left, far_child = down ? left : right;
  const std::int64_t nearest = params_.early_out ? nearest_ : no_hit;
  const std::int64_t far_tmin = std::max(now_.tmin, now_.dist1), near_tmax = std::min(now_.tmax, now_.dist0);
  const bool to_near = now_.dist0 >= now_.tmin && now_.tmin <= nearest;
  const bool to_far = now_.dist1 <= now_.tmax && far_tmin <= nearest;
  if (to_near && to_far) {
    outcome_.overflow = now_.stack_pos == most_bih_stack_entries && !params_.stack_wraps;
    pushed_ = pack({far_child, far_tmin, now_.tmax});
    out_.we = !outcome_.overflow;
    out_.addr3x = out_.addr1x = stack_entry(now_.stack_pos);
    next_.tmax = near_tmax;
    next_.near_child = near_child;
    next_.stack_pos = static_cast<std::uint8_t>((now_.stack_pos + 1) % bih_stack_words);
    next_.state = bih_state::push;
  } else if (to_near) {
    out_.addr3x = near_child;
    next_.tmax = near_tmax;
    next_.state = bih_state::node;
  } else if (to_far) {
    out_.addr3x = far_child;
    next_.tmin = far_tmin;
    next_.state = bih_state::node;
  } else {
    go_back();
  }
}

void bih_machine::settle_pop() {
  const bih_stack_entry e = unpack(words());
  next_.tmin = e.tmin;
  next_.tmax = e.tmax;
  if (params_.early_out && e.tmin > nearest_) {
    go_back();
    return;
  }
  out_.addr3x = e.far & memory_->address_mask();
  next_.state = bih_state::node;
}

void bih_machine::settle_leaf() {
  const bool empty = now_.triangles_left == 0 && !params_.empty_leaf_hangs;
  if (!empty && divider_clocks_ != 0) return;
  out_.tri_en = !empty;
  next_.triangles_left = now_.triangles_left - 1;
  if (now_.triangles_left == 1 || !out_.tri_en) {
    go_back();
    return;
  }
  out_.addr1x = now_.next_triangle;
  next_.next_triangle = (now_.next_triangle + 1) & memory_->address_mask();
}

/// To the last entry of the stack, or to the next ray.
void bih_machine::go_back() {
  if (now_.stack_pos == 0) {
    out_.done = true;
    next_.state = bih_state::aabb;
    return;
  }
  out_.addr3x = out_.addr1x = stack_entry(now_.stack_pos - 1u);
  next_.stack_pos = static_cast<std::uint8_t>(now_.stack_pos - 1);
  next_.state = bih_state::pop;
}

void bih_machine::inherit(const bih_kept& kept) {
  stack_ = kept.stack;
  inherit(static_cast<const bih_kept_registers&>(kept));
}

void bih_machine::inherit(const bih_kept_registers& kept) {
  RTU_CHECK(static_cast<int>(now_.state), ==, static_cast<int>(bih_state::aabb));
  now_.tmin = kept.tmin;
  now_.tmax = kept.tmax;
  now_.dist0 = kept.dist0;
  now_.dist1 = kept.dist1;
  now_.address3x = kept.address3x;
  now_.address1x = kept.address1x;
  divider_clocks_ = kept.divider_clocks;
  settle();
}

bih_kept bih_machine::kept() const {
  return {{now_.tmin, now_.tmax, now_.dist0, now_.dist1, now_.address3x, now_.address1x, divider_clocks_}, stack_};
}

}  // namespace rtusim
