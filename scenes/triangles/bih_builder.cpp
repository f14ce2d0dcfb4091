#include "scenes/triangles/bih_builder.h"

#include <algorithm>

#include "modules/config/error.h"

namespace rtusim {
namespace {

class builder {
 public:
  builder(const std::vector<triangle_box>& boxes, unsigned leaf_size) : boxes_(boxes), leaf_size_(leaf_size), order_(boxes.size()) {
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    nodes_.resize(1);
    build(0, 0, boxes.size());
  }

  const std::vector<bih_words>& nodes() const { return nodes_; }
  /// The lists of all leaves lie as their triangles do.
  const std::vector<std::uint32_t>& lists() const { return order_; }

 private:
  void build(std::size_t node, std::size_t begin, std::size_t end) {
    const auto count = end - begin;
    if (count <= leaf_size_) {
      nodes_[node] = make_leaf(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(count));
      return;
    }
    const triangle_box box = around(begin, end);
    unsigned axis = 0;
    for (unsigned i = 1; i < 3; ++i)
      if (box.upper[i] - box.lower[i] > box.upper[axis] - box.lower[axis]) axis = i;
    const std::size_t middle = split(begin, end, axis, box.lower[axis] + box.upper[axis]);
    const std::size_t left = nodes_.size();
    nodes_.resize(left + 2);
    nodes_[node] = make_inner(axis, static_cast<std::uint32_t>(left), static_cast<std::uint64_t>(around(begin, middle).upper[axis]),
                              static_cast<std::uint64_t>(around(middle, end).lower[axis]));
    build(left, begin, middle);
    build(left + 1, middle, end);
  }

  /// Twice the centre of a triangle's box.
  std::int64_t centre2(std::uint32_t triangle, unsigned axis) const { return boxes_[triangle].lower[axis] + boxes_[triangle].upper[axis]; }

  std::size_t split(std::size_t begin, std::size_t end, unsigned axis, std::int64_t middle2) {
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto middle = std::stable_partition(at(begin), at(end), [&](std::uint32_t t) { return centre2(t, axis) < middle2; });
    if (middle != at(begin) && middle != at(end)) return static_cast<std::size_t>(middle - order_.begin());
    std::stable_sort(at(begin), at(end), [&](std::uint32_t a, std::uint32_t b) { return centre2(a, axis) < centre2(b, axis); });
    return begin + (end - begin) / 2;
  }

  triangle_box around(std::size_t begin, std::size_t end) const {
    triangle_box box = boxes_[order_[begin]];
    for (std::size_t i = begin + 1; i < end; ++i)
      for (unsigned axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], boxes_[order_[i]].lower[axis]);
        box.upper[axis] = std::max(box.upper[axis], boxes_[order_[i]].upper[axis]);
      }
    return box;
  }

  const std::vector<triangle_box>& boxes_;
  unsigned leaf_size_;
  std::vector<std::uint32_t> order_;
  std::vector<bih_words> nodes_;
};

/// Address bits for so many nodes and list words; more than any memory has if there are too many.
unsigned bits_for(std::size_t words) {
  unsigned bits = least_bih_address_bits;
  while (bits <= most_bih_address_bits && words > (std::size_t{1} << bits) - bih_stack_words) ++bits;
  return bits;
}

}  // namespace

bih_memory build_bih(const std::vector<triangle_box>& boxes, unsigned leaf_size, unsigned address_bits, const std::string& place) {
  if (leaf_size == 0) throw input_error(place, "at most 0 triangles a leaf", "at least 1");
  if (boxes.empty()) throw input_error(place, "no triangles", "a model with something to hit");
  const builder built(boxes, leaf_size);
  const std::size_t words = std::max(built.nodes().size(), built.lists().size());
  bih_memory memory(address_bits);
  if (words > memory.stack_address()) {
    const unsigned bits = bits_for(words);
    throw input_error(place,
                      fmt::format("{} nodes and {} list words of {} triangles", built.nodes().size(), built.lists().size(), boxes.size()),
                      fmt::format("at most {} of each for bih_core.address_bits = {}; {}", memory.stack_address(), address_bits,
                                  bits > most_bih_address_bits ? fmt::format("{} bits are the most", most_bih_address_bits)
                                                               : fmt::format("{} would do", bits)));
  }
  for (std::size_t i = 0; i < built.nodes().size(); ++i)
    for (unsigned w = 0; w < 3; ++w) memory.words[w][i] = built.nodes()[i][w];
  for (std::size_t i = 0; i < built.lists().size(); ++i) memory.words[3][i] = built.lists()[i];
  memory.corner = boxes.front().upper;
  for (const triangle_box& box : boxes)
    for (unsigned axis = 0; axis < 3; ++axis) memory.corner[axis] = std::max(memory.corner[axis], box.upper[axis]);
  memory.triangles.resize(boxes.size());
  check_bih(memory, place);
  memory.triangles.clear();
  return memory;
}

}  // namespace rtusim
