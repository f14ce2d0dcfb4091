#pragma once

#include <cstddef>

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"
#include "modules/numeric/avx2.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_batch.h"
#include "modules/svo_core/svo_params.h"

#if RTU_HAS_AVX2
namespace rtusim {

/// What `walk_in_lanes` needs to know.
struct lane_setup {
  const svo_core_params& core;  ///< words of 32 bits at most
  const numeric::float_to_fixed_errata& conversion;
  const numeric::float_to_fixed_converter& converter;
  const word_view& octree;  ///< addresses of 30 bits at most
};

/// As `svo_batch`, on a processor with AVX2; of at most `lane_batch` jobs.
inline constexpr std::size_t lane_batch = 256;
void walk_in_lanes(const lane_setup& with, const job_packet* jobs, std::size_t count, svo_walked* to,
                   numeric::float_to_fixed_stats& counted);

}  // namespace rtusim
#endif
