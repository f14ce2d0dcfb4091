#pragma once

#include <filesystem>

#include "scenes/voxel_grid.h"

namespace rtusim {

/// Reads a `.binvox` (Min, binvox file format, versions 1 and 2), zipped or not: a cube of 1 to 1024 voxels an edge as runs of empty and
/// filled ones, y fastest, then z, then x. Where it lies in a mesh's space (`translate`, `scale`) is left out.
///
/// `resolution`: of the grid, in whose middle the cube comes to stand (half a voxel lower if one is left over); 0 for the least power of
/// two that holds it.
/// Errors: input_error that names the line or the byte, when the file can't be read, its header is garbled, its edges differ or are
/// longer than `resolution`, or its runs hold more or fewer voxels than it claims.
voxel_grid read_binvox(const std::filesystem::path& file, unsigned resolution = 0);

/// Writes a `.binvox` of version 1, whose cube spans [-1,1]^3.
/// Errors: input_error when the file can't be written.
void write_binvox(const std::filesystem::path& file, const voxel_grid& grid);

}  // namespace rtusim
