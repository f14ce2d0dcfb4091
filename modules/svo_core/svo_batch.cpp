#include "modules/svo_core/svo_batch.h"

#include <algorithm>

#include "modules/job_manager/job_manager.h"
#include "modules/svo_core/svo_lanes.h"

namespace rtusim {

svo_batch::svo_batch(const svo_core_params& p, const numeric::float_to_fixed_errata& conversion, const word_view& octree, bool lanes)
    : params_(p),
      conversion_(conversion),
      converter_(p.format, conversion),
      octree_(octree),
      walk_(p),
      lanes_(lanes && numeric::has_avx2() && p.format.width() <= 32) {}

void svo_batch::operator()(const job_packet* jobs, std::size_t count, svo_walked* to, numeric::float_to_fixed_stats& counted) const {
#if RTU_HAS_AVX2
  if (lanes_) {
    for (std::size_t i = 0; i < count; i += lane_batch)
      walk_in_lanes({params_, conversion_, converter_, octree_}, jobs + i, std::min(lane_batch, count - i), to + i, counted);
    return;
  }
#endif
  one_by_one(jobs, count, to, counted);
}

void svo_batch::one_by_one(const job_packet* jobs, std::size_t count, svo_walked* to, numeric::float_to_fixed_stats& counted) const {
  traversal_job job;
  for (std::size_t i = 0; i < count; ++i) {
    convert(jobs[i], converter_, counted, job);
    const svo_outcome o = walk_(job, octree_);
    to[i] = {o.t_hit, o.job_word, o.cost, o.pushes, o.depth, o.axis, o.hit, o.overflow};
  }
}

}  // namespace rtusim
