#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "modules/formats/bih_word.h"
#include "modules/formats/quantisation.h"

namespace rtusim {

/// A bounding interval hierarchy as it lies in the unit's memories (Hanika 2007, sec. 3.4), with the triangles that its lists name.
/// The root is node 0.
struct bih_memory {
  unsigned address_bits = 10;
  std::array<std::vector<std::uint64_t>, 4> words;  ///< word 0 to 3 of each of the 2^address_bits addresses
  per_axis<std::int64_t> corner{};                  ///< upper corner of the scene's box; the lower one is 0
  std::vector<accelerated_triangle> triangles;

  bih_memory() = default;
  /// All words 0.
  explicit bih_memory(unsigned bits) : address_bits(bits) {
    for (auto& w : words) w.resize(std::size_t{1} << bits);
  }
  std::uint32_t address_mask() const { return (std::uint32_t{1} << address_bits) - 1; }
  /// Where the stack begins: nodes and lists lie below.
  std::uint32_t stack_address() const { return (std::uint32_t{1} << address_bits) - bih_stack_words; }
};

/// Reads a folder of text files, one hexadecimal word a line, each file plain or zipped (`.txt`, `.txt.gz`): `bih0` to `bih3`, words 0 to 3
/// of 2^address_bits addresses; `scene_aabb`, the upper corner x, y, z; `tri_ram`, a triangle a line: pp pq d e1p e1q e2p e2q np nq r,
/// sign-extended to 36 bits. Without `tri_ram` there are no triangles.
/// Errors: input_error that names file and line: a file that can't be read, another number of lines, what is no hexadecimal number, is
/// wider than 36 bits, or does not fit its width in `widths`.
bih_memory read_bih(const std::filesystem::path& folder, unsigned address_bits, const quantisation& widths = {});

/// Writes these files, not zipped, into a folder that is made if need be.
/// Errors: input_error when the folder or a file can't be written.
void write_bih(const std::filesystem::path& folder, const bih_memory& memory);

/// What `check_bih` asks of a hierarchy.
struct bih_rules {
  /// Raw words for a unit alone: only what would keep a ray from ending is refused.
  bool raw = false;
  /// The erratum of the core: with `raw` a leaf without triangles is refused for it alone.
  bool empty_leaf_hangs = false;
};

/// The size of a hierarchy.
struct bih_summary {
  std::uint64_t inner_nodes = 0, leaves = 0;  ///< that the root leads to
  std::uint64_t listed = 0;                   ///< triangles in the lists of these leaves
  std::uint64_t levels = 0;                   ///< nodes from the root to the deepest leaf
  unsigned stack_entries = 0;                 ///< that a ray needs at most; not known better than 255
  std::uint64_t most_cycles = 0;              ///< that a ray takes at most, if it met everything
};

/// Checks that every ray through the hierarchy ends, and, unless `raw`, that it stays in the memory. Subtrees and lists may be shared.
/// `place` names the memory in errors.
/// Errors: input_error that names the node: children in the stack's addresses or outside of the memory, a loop, a ray of more than
/// 2^24 cycles; unless `raw` also leaves without triangles, lists that run out of the memory, triangles that are not there, and more levels
/// than the stack has entries for.
bih_summary check_bih(const bih_memory& memory, const std::string& place, const bih_rules& rules = {});

}  // namespace rtusim
