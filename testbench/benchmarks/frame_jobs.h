#pragma once

#include <string>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/rtu/design.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/kinds/driver.h"

namespace rtusim {

/// What is measured: the thesis' frame of 1280x720 and the dragon of 32 voxels an edge, as built.
inline const svo_image& dragon() {
  static const svo_image image = read_svo(RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/dragon_32.svo");
  return image;
}

inline design as_built(unsigned cores = 16) {
  design d;
  d.rtu.cores = cores;
  d.of<svo_kind>().conversion = {true, true, true};
  svo_core_params& core = d.of<svo_kind>().core;
  core.far_popcount = core.negative_t = core.positive_normals = core.tm_wrap = core.stale_miss = true;
  d.result_manager_.valid_withdrawn = true;
  return d;
}

inline const std::vector<job_packet>& frame_packets() {
  static const std::vector<job_packet> packets = camera_jobs({}, {}, {true}, 0);
  return packets;
}

inline const std::vector<traversal_job>& frame_jobs() {
  static const std::vector<traversal_job> jobs = [] {
    std::vector<traversal_job> all;
    numeric::float_to_fixed_stats stats;
    const numeric::float_to_fixed_converter converter(as_built().of<svo_kind>().format, as_built().of<svo_kind>().conversion);
    for (const job_packet& p : frame_packets()) convert(p, converter, stats, all.emplace_back());
    return all;
  }();
  return jobs;
}

}  // namespace rtusim
