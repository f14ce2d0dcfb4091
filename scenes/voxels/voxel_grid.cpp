#include "scenes/voxels/voxel_grid.h"

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

std::uint64_t voxel_grid::count() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t block : blocks_) sum += static_cast<std::uint64_t>(__builtin_popcountll(block));
  return sum;
}

}  // namespace rtusim
