#pragma once

#include "scenes/mesh.h"
#include "scenes/voxel_grid.h"

namespace rtusim {

/// How large a model stands in the root cube [-1,1]^3: its largest half extent, the rest of the way to 1 is margin.
inline constexpr double default_fit = 0.98;

/// Fills every voxel that the mesh's surface touches, its border included: an exact test of triangle against box by separating axes
/// (Akenine-Moller 2001), in binary64.
///
/// The middle of the mesh's bounding box comes to the middle of the root cube, and half of its longest edge becomes `fit`
/// (above 0, at most 1). `resolution`: voxels an edge, a power of two from 2 to 1024.
voxel_grid voxelise_surface(const mesh& m, unsigned resolution, double fit = default_fit);

}  // namespace rtusim
