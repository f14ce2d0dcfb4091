#pragma once

#include <cstdint>
#include <vector>

namespace rtusim {

/// Filled and empty voxels of a cube with 2^k voxels an edge, one bit each.
///
/// The bits lie in Morton order (x lowest, then y, then z), so that every cube of the octree above the voxels is one aligned
/// run: eight siblings are a byte in the order of an SVO's masks, a cube of 4x4x4 is one 64-bit block.
class voxel_grid {
 public:
  static constexpr unsigned least_resolution = 2;
  static constexpr unsigned most_resolution = 1024;  // 128 MB

  static constexpr bool is_resolution(std::uint64_t r) { return r >= least_resolution && r <= most_resolution && (r & (r - 1)) == 0; }

  /// An empty grid; `resolution` is a power of two from 2 to 1024.
  explicit voxel_grid(unsigned resolution);

  unsigned resolution() const { return 1U << levels_; }
  /// The levels of an octree whose finest cubes are the voxels: log2 of the resolution.
  unsigned levels() const { return levels_; }

  bool at(unsigned x, unsigned y, unsigned z) const {
    const std::uint32_t i = morton(x, y, z);
    return ((blocks_[i >> 6] >> (i & 63)) & 1) != 0;
  }
  void fill(unsigned x, unsigned y, unsigned z) {
    const std::uint32_t i = morton(x, y, z);
    blocks_[i >> 6] |= std::uint64_t{1} << (i & 63);
  }
  /// Fills the aligned cube of 8^`level` voxels that is number `index` in Morton order.
  void fill_cube(unsigned level, std::uint32_t index);

  /// Fills those voxels of block `number` whose bits are set.
  void fill_block(std::uint32_t number, std::uint64_t bits) { blocks_[number] |= bits; }

  /// How many voxels are filled.
  std::uint64_t count() const;
  /// The 4x4x4 cubes in Morton order; at resolution 2 the low byte of the only one.
  const std::vector<std::uint64_t>& blocks() const { return blocks_; }
  /// The number in Morton order of what lies at these coordinates: of a voxel in its block, of a block by blocks from the border.
  static constexpr std::uint32_t morton(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return spread(x) | (spread(y) << 1) | (spread(z) << 2);
  }

  friend bool operator==(const voxel_grid& a, const voxel_grid& b) { return a.levels_ == b.levels_ && a.blocks_ == b.blocks_; }
  friend bool operator!=(const voxel_grid& a, const voxel_grid& b) { return !(a == b); }

 private:
  // Spreads ten bits to every third place.
  static constexpr std::uint32_t spread(std::uint32_t v) {
    v = (v | (v << 16)) & 0x030000ff;
    v = (v | (v << 8)) & 0x0300f00f;
    v = (v | (v << 4)) & 0x030c30c3;
    return (v | (v << 2)) & 0x09249249;
  }

  unsigned levels_ = 0;
  std::vector<std::uint64_t> blocks_;
};

}  // namespace rtusim
