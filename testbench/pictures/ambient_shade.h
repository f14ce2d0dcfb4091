#pragma once

#include <array>
#include <vector>

#include "testbench/pictures/frame.h"

namespace rtusim {

/// What a lit picture needs of each pixel beside its colour.
struct surface_shade {
  std::vector<std::array<float, 3>> normals;  ///< of length 1; 0 where nothing was hit
  std::vector<float> open;                    ///< how much of the sky the surroundings leave, 0 to 1; 1 where nothing was hit
};

/// Both are told from the points and normals of the pixels around a pixel, without a further ray.
///
/// Normals: a triangle's is its own. Of voxels that are but a few pixels wide the faces around are averaged, as the eye would; large ones
/// show their faces. The sky: McGuire, Mara, Luebke 2012 (Scalable Ambient Obscurance), sec. 2.3; surroundings reach 0.22 world units.
/// Without places in the frame, and for rays that lie on no grid of pixels, normals are the faces' and the sky is open.
surface_shade shade_of(const frame& picture);

}  // namespace rtusim
