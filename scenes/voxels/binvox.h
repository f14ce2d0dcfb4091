#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "scenes/voxels/voxel_grid.h"

namespace rtusim {

/// The voxels of a cube of any edge, in the middle of a grid (half a voxel lower if one is left over), and where they lie.
struct voxel_cube {
  voxel_grid grid;
  unsigned edge;                                ///< in voxels, at most the grid's
  std::array<double, 3> translate{-1, -1, -1};  ///< the cube's lower corner in the space of its maker
  double scale = 2;                             ///< the length of its edge there

  /// A whole grid, which spans [-1,1]^3.
  explicit voxel_cube(voxel_grid g) : grid(std::move(g)), edge(grid.resolution()) {}

  /// The coordinate of the cube's first voxels in the grid.
  unsigned first() const { return (grid.resolution() - edge) / 2; }
  /// Gives the cube another edge of at most the grid's. Each voxel stays where it lies; what lies outside is no longer in the cube.
  void set_edge(unsigned voxels);
  /// How many voxels of the cube are filled.
  std::uint64_t count() const;
};

/// Reads a `.binvox` (Min, binvox file format, versions 1 and 2), zipped or not: a cube of 1 to 1024 voxels an edge as runs of empty and
/// filled ones, y fastest, then z, then x. The lines of its header may come in any order, with blank ones and comments (`#`) among them.
///
/// `resolution`: of the grid; 0 for the least power of two that holds the cube.
/// Errors: input_error that names the line or the byte, when the file can't be read, its header is garbled, its edges differ or are
/// longer than `resolution`, or its runs hold more or fewer voxels than it claims.
voxel_cube read_binvox(const std::filesystem::path& file, unsigned resolution = 0);

/// Writes a `.binvox` of version 1.
/// Errors: input_error when the file can't be written.
void write_binvox(const std::filesystem::path& file, const voxel_cube& cube);

}  // namespace rtusim
