#include "scenes/voxel_grid.h"

#include <algorithm>

#include "modules/config/error.h"

namespace rtusim {

voxel_grid::voxel_grid(unsigned resolution) {
  RTU_CHECK(is_resolution(resolution), ==, true);
  while ((1U << levels_) < resolution) ++levels_;
  const std::uint64_t voxels = std::uint64_t{1} << (3 * levels_);
  blocks_.resize(static_cast<std::size_t>((voxels + 63) / 64));
}

void voxel_grid::fill_cube(unsigned level, std::uint32_t index) {
  RTU_CHECK(level, <=, levels_);
  RTU_CHECK(std::uint64_t{index} >> (3 * (levels_ - level)), ==, 0U);
  const std::uint64_t first = std::uint64_t{index} << (3 * level);
  if (level < 2) {
    const std::uint64_t bits = level == 0 ? 1 : 0xff;
    blocks_[first >> 6] |= bits << (first & 63);
  } else {
    const auto begin = blocks_.begin() + static_cast<std::ptrdiff_t>(first >> 6);
    std::fill_n(begin, std::uint64_t{1} << (3 * (level - 2)), ~std::uint64_t{0});
  }
}

void voxel_grid::accumulate_parity(unsigned axis) {
  RTU_CHECK(axis, <, 3U);
  // The places in a block where the low or the high bit of the coordinate is set, and how far these bits reach.
  constexpr std::uint64_t low_set[] = {0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc, 0xf0f0f0f0f0f0f0f0};
  constexpr std::uint64_t high_set[] = {0xff00ff00ff00ff00, 0xffff0000ffff0000, 0xffffffff00000000};
  const std::uint64_t low = low_set[axis], high = high_set[axis];
  const unsigned one = 1U << axis, two = 8U << axis;

  const unsigned edge = levels_ < 2 ? 1 : resolution() / 4;
  for (unsigned v = 0; v < edge; ++v)
    for (unsigned u = 0; u < edge; ++u) {
      std::uint64_t before = 0;  // the parity behind the last block, at each of a block's 64 places
      for (unsigned along = 0; along < edge; ++along) {
        const std::uint32_t i = axis == 0 ? morton(along, u, v) : axis == 1 ? morton(u, along, v) : morton(u, v, along);
        std::uint64_t b = blocks_[i];
        b ^= (b << one) & low;
        const std::uint64_t of_pair = (b & low) | ((b & low) >> one);
        b ^= (of_pair << two) & high;
        b ^= before;
        blocks_[i] = b;
        const std::uint64_t last = b & low & high;
        before = last | (last >> one);
        before |= before >> two;
      }
    }
  if (levels_ < 2) blocks_[0] &= 0xff;
}

voxel_grid& voxel_grid::operator|=(const voxel_grid& other) {
  RTU_CHECK(levels_, ==, other.levels_);
  for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i] |= other.blocks_[i];
  return *this;
}

std::uint64_t voxel_grid::count() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t block : blocks_) sum += static_cast<std::uint64_t>(__builtin_popcountll(block));
  return sum;
}

}  // namespace rtusim
