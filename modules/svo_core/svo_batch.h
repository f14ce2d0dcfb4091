#pragma once

#include <cstddef>
#include <cstdint>

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_params.h"
#include "modules/svo_core/svo_walk.h"

namespace rtusim {

/// What a ray comes to in a voxel core, whenever it gets there. Has no initial values.
struct svo_walked {
  std::int64_t t_hit;  ///< of a hit, else 0
  std::uint32_t job_word;
  std::uint32_t cost;
  std::uint32_t pushes;
  std::uint8_t depth;
  std::int8_t axis;  ///< of a hit, else no_axis
  bool hit;
  bool overflow;
};

/// Converts jobs and walks them through an octree: ray by ray what `convert` and `svo_walk` come to.
///
/// Where the processor has AVX2 and words have 32 bits at most, eight rays go side by side to the end of the last:
/// letting others take the place of those that have ended was slower, in a model of 256 voxels an edge, too.
class svo_batch {
 public:
  /// The words that `octree` shows must outlive this. `lanes`: rays go side by side where they can.
  svo_batch(const svo_core_params& p, const numeric::float_to_fixed_errata& conversion, const word_view& octree, bool lanes = true);

  /// Adds to what the conversion counts.
  void operator()(const job_packet* jobs, std::size_t count, svo_walked* to, numeric::float_to_fixed_stats& counted) const;

 private:
  void one_by_one(const job_packet* jobs, std::size_t count, svo_walked* to, numeric::float_to_fixed_stats& counted) const;

  svo_core_params params_;
  numeric::float_to_fixed_errata conversion_;
  numeric::float_to_fixed_converter converter_;
  word_view octree_;
  svo_walk walk_;
  bool lanes_;
};

}  // namespace rtusim
