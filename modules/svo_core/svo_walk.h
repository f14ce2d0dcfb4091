#pragma once

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"
#include "modules/svo_core/svo_params.h"

namespace rtusim {

/// A cube of an octree: one of 2^levels an edge, counted from the lower corner of the root cube along x, y, z.
struct svo_cube {
  unsigned levels = 0;
  per_axis<std::uint32_t> place{};
};

/// Walks a ray to its end at once: the outcome that `svo_machine` reaches cycle by cycle, with its cost.
class svo_walk {
 public:
  explicit svo_walk(const svo_core_params& p);

  svo_outcome operator()(const traversal_job& job, const word_view& memory) const { return walk_(job, memory, params_, nullptr); }
  /// The same, and the cube that is hit, as the way down to it tells; left as it is on a miss.
  svo_outcome operator()(const traversal_job& job, const word_view& memory, svo_cube& hit) const {
    return walk_to_cube_(job, memory, params_, &hit);
  }

 private:
  using function = svo_outcome (*)(const traversal_job&, const word_view&, const svo_core_params&, svo_cube*);
  svo_core_params params_;
  function walk_;
  function walk_to_cube_;
};

}  // namespace rtusim
