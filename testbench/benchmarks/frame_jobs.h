#pragma once

#include <string>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/rtu/design.h"
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
  d.driver.last_sign_only = true;
  d.float_to_fixed = {true, true, true};
  d.svo_core.far_popcount = d.svo_core.negative_t = d.svo_core.positive_normals = d.svo_core.tm_wrap = d.svo_core.stale_miss = true;
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
    const numeric::float_to_fixed_converter converter(as_built().fixed_point, as_built().float_to_fixed);
    for (const job_packet& p : frame_packets()) convert(p, converter, stats, all.emplace_back());
    return all;
  }();
  return jobs;
}

}  // namespace rtusim
