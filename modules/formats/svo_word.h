#pragma once

#include <cstdint>

/// The bit fields of a descriptor word of a sparse voxel octree (Espe 2019, sec. 4.2), functions of the word alone.
///
/// | bits | field |
/// | --- | --- |
/// | 31 | far: the pointer leads to a word that holds the offset of the children |
/// | 30:16 | child pointer, unsigned, relative to this word |
/// | 15:8 | valid mask, bit c for child c: something is filled there |
/// | 7:0 | leaf mask: the child is filled altogether |
///
/// A child's index has bit 0 for x, bit 1 for y, bit 2 for z, set in the upper half. Only the children that are valid and no
/// leaf have a word of their own; these lie side by side in child order, the group.
namespace rtusim {

/// The largest offset that a child pointer holds.
inline constexpr std::uint32_t max_child_pointer = 0x7fff;

constexpr bool is_far(std::uint32_t word) { return (word >> 31) != 0; }
constexpr std::uint32_t child_pointer(std::uint32_t word) { return (word >> 16) & max_child_pointer; }
constexpr std::uint32_t valid_mask(std::uint32_t word) { return (word >> 8) & 0xff; }
constexpr std::uint32_t leaf_mask(std::uint32_t word) { return word & 0xff; }

constexpr bool is_valid(std::uint32_t word, unsigned slot) { return ((word >> (8 + slot)) & 1) != 0; }
constexpr bool is_leaf(std::uint32_t word, unsigned slot) { return ((word >> slot) & 1) != 0; }

/// The children that have a word of their own, bit c for child c.
constexpr std::uint32_t node_mask(std::uint32_t word) { return valid_mask(word) & ~leaf_mask(word); }
/// How many words the group has.
constexpr unsigned child_nodes(std::uint32_t word) { return static_cast<unsigned>(__builtin_popcount(node_mask(word))); }
/// How many words of the group come before that of the child in `slot` (0 to 7).
constexpr unsigned child_nodes_before(std::uint32_t word, unsigned slot) {
  return static_cast<unsigned>(__builtin_popcount(node_mask(word) & ((std::uint32_t{1} << slot) - 1)));
}

/// A descriptor from its fields; `pointer` has 15 bits, the masks have 8.
constexpr std::uint32_t make_descriptor(bool far, std::uint32_t pointer, std::uint32_t valid, std::uint32_t leaf) {
  return (std::uint32_t{far} << 31) | (pointer << 16) | (valid << 8) | leaf;
}

}  // namespace rtusim
