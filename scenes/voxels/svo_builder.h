#pragma once

#include <string>

#include "modules/formats/svo_image.h"
#include "scenes/voxels/voxel_grid.h"

namespace rtusim {

/// How an image is laid out.
struct svo_layout {
  /// Places groups behind far pointers so that the unit as built reads them, too: it counts the children before a slot in the far word
  /// instead of the descriptor (erratum `far_popcount`), so the word must hold the same count. Costs unused words.
  bool far_as_built = false;
};

/// Builds an octree from voxels: depth first, each group of children followed by the far words that these need, then by the
/// children's subtrees in child order. A cube that is filled altogether is one leaf; the root itself never is.
/// The image may be larger than a design addresses: `check_svo` tells.
/// Errors: input_error for a grid without a filled voxel; `place` names the model.
svo_image build_svo(const voxel_grid& grid, const std::string& place, const svo_layout& layout = {});

/// The voxels of an image; `resolution` at least 2^(levels of descriptors). Reverses `build_svo`.
/// The image is sound (`check_svo`).
voxel_grid voxels_of(const svo_image& image, unsigned resolution);

/// The same at any resolution: a voxel is filled if anything within it is.
voxel_grid coarse_voxels_of(const svo_image& image, unsigned resolution);

}  // namespace rtusim
