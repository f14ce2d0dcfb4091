#pragma once

#include <functional>
#include <string>

#include "scenes/meshes/mesh.h"
#include "scenes/voxels/voxel_grid.h"

namespace rtusim {

/// How large a model stands in the root cube [-1,1]^3: its largest half extent, the rest of the way to 1 is margin.
inline constexpr double default_fit = 0.98;

/// Told now and then which share of a work is done, 0 to 1.
using progress_handler = std::function<void(double)>;

/// Fills every voxel that the mesh's surface touches, its border included: an exact test of triangle against box by separating axes
/// (Akenine-Moller 2001), in binary64.
///
/// The middle of the mesh's bounding box comes to the middle of the root cube, and half of its longest edge becomes `fit`
/// (above 0, at most 1). `resolution`: voxels an edge, a power of two from 2 to 1024.
voxel_grid voxelise_surface(const mesh& m, unsigned resolution, double fit = default_fit, const progress_handler& progress = {});

/// Fills the voxels of the surface, and those around whose centre the surface winds: as often as it is left by a ray through the back of
/// a face, less those through the front, is not 0. So bodies that overlap are one, one within another is nothing more, and one within
/// another that is turned inside out is a hollow.
///
/// The crossings are counted without rounding, on vertices at whole multiples of 2^-20 of a voxel, and along each of the three axes: all
/// must agree. Two bits a voxel, 256 MB at 1024, and 17 MB. `place` names the mesh in errors.
/// Errors: input_error for a mesh that is not closed (`find_open_edges`) or has faces turned (`find_turned_edges`), which tells the number
/// of these edges and where the first lies.
voxel_grid voxelise_solid(const mesh& m, unsigned resolution, const std::string& place, double fit = default_fit,
                          const progress_handler& progress = {});

}  // namespace rtusim
