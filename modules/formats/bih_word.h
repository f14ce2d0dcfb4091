#pragma once

#include <array>
#include <cstdint>

/// The bit fields of a bounding interval hierarchy's words (Hanika 2007, sec. 3.4), functions of the words alone. A = address bits.
///
/// | word | inner node | leaf | list | stack entry |
/// | --- | --- | --- | --- | --- |
/// | 0 | 2+A:3 left child (right = left + 1), 1:0 axis | 2+A:3 first list address, 1:0 = 3 | | tmin, bits 35..0 |
/// | 1 | clip0: upper bound of left | 31:0 triangles | | 35:31 tmax, 4..0; 30:27 far node, 17..14; 26:0 tmin, 62..36 |
/// | 2 | clip1: lower bound of right | | | tmax, 40..5 |
/// | 3 | | | 28:0 triangle | 35:26 far node, 9..0; 25:22 far node, 13..10; 21:0 tmax, 62..41 |
///
/// Words 0 to 2 share an address, word 3 has one of its own. The stack lies in the last 32 addresses.
/// As built A is 10, and the bits of the far node above its tenth are 0.
namespace rtusim {

inline constexpr unsigned bih_word_bits = 36;
inline constexpr std::uint64_t greatest_bih_word = (std::uint64_t{1} << bih_word_bits) - 1;
inline constexpr unsigned least_bih_address_bits = 6, most_bih_address_bits = 18;

/// Addresses that the stack takes of the memory.
inline constexpr std::uint32_t bih_stack_words = 32;
/// Entries that the stack holds: its pointer has 5 bits, and 0 is the empty stack.
inline constexpr unsigned most_bih_stack_entries = 31;

/// The words of an address, or of two: 0 to 2, and 3.
using bih_words = std::array<std::uint64_t, 4>;

/// In place of an axis: the node is a leaf.
inline constexpr unsigned bih_leaf = 3;

constexpr unsigned node_axis(std::uint64_t word0) { return static_cast<unsigned>(word0 & 3); }
/// Left child or first list address, with all bits that the word has for it: 33.
constexpr std::uint64_t node_pointer(std::uint64_t word0) { return word0 >> 3; }
constexpr std::uint32_t leaf_triangles(std::uint64_t word1) { return static_cast<std::uint32_t>(word1); }
constexpr std::uint32_t list_triangle(std::uint64_t word3) { return static_cast<std::uint32_t>(word3 & 0x1fffffff); }

/// An inner node's words 0 to 2.
constexpr bih_words make_inner(unsigned axis, std::uint32_t left, std::uint64_t clip0, std::uint64_t clip1) {
  return {std::uint64_t{left} << 3 | axis, clip0, clip1, 0};
}
/// A leaf's words 0 to 2.
constexpr bih_words make_leaf(std::uint32_t first, std::uint32_t triangles) {
  return {std::uint64_t{first} << 3 | bih_leaf, triangles, 0, 0};
}

/// What the core keeps of a child that it visits later.
struct bih_stack_entry {
  std::uint32_t far = 0;  ///< the node
  std::int64_t tmin = 0;  ///< 63 bits, signed
  std::int64_t tmax = 0;
};

constexpr bih_words pack(const bih_stack_entry& e) {
  const std::uint64_t tmin = static_cast<std::uint64_t>(e.tmin) & ~std::uint64_t{0} >> 1;
  const std::uint64_t tmax = static_cast<std::uint64_t>(e.tmax) & ~std::uint64_t{0} >> 1;
  const std::uint64_t far = e.far;
  return {tmin & greatest_bih_word, (tmax & 0x1f) << 31 | (far >> 14 & 0xf) << 27 | tmin >> 36, tmax >> 5 & greatest_bih_word,
          (far & 0x3ff) << 26 | (far >> 10 & 0xf) << 22 | tmax >> 41};
}

constexpr bih_stack_entry unpack(const bih_words& w) {
  const std::uint64_t tmin = (w[1] & 0x7ffffff) << 36 | w[0];
  const std::uint64_t tmax = (w[3] & 0x3fffff) << 41 | w[2] << 5 | w[1] >> 31;
  const std::uint64_t far = (w[3] >> 26 & 0x3ff) | (w[3] >> 22 & 0xf) << 10 | (w[1] >> 27 & 0xf) << 14;
  return {static_cast<std::uint32_t>(far), static_cast<std::int64_t>(tmin << 1) >> 1, static_cast<std::int64_t>(tmax << 1) >> 1};
}

}  // namespace rtusim
