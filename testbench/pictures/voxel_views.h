#pragma once

#include <array>

#include "scenes/voxels/voxel_grid.h"
#include "testbench/pictures/rgb_picture.h"

namespace rtusim {

/// Four pictures of a grid on one sheet, laid out as on an engineer's drawing: above left the slice through the middle of y, seen from
/// above; below it that of z, seen from the front; beside this that of x, seen from the right; above right a view from the right front.
/// The letters of a slice stand at the greater ends of its axes. A pixel of a slice is filled if a voxel within it is.
///
/// `lower`, `upper`: corners of a box around all that is filled, in edges of the cube, 0 to 1; the view shows that.
rgb_picture voxel_views(const voxel_grid& grid, const std::array<double, 3>& lower, const std::array<double, 3>& upper);

}  // namespace rtusim
