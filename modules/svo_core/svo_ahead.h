#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/formats/packets.h"
#include "modules/svo_core/svo_batch.h"

namespace rtusim {

/// Walks a list of jobs in batches, ahead of the clock: what a ray comes to follows from its job alone. Jobs are taken in the order of the
/// list.
class svo_ahead {
 public:
  /// The jobs, and the words that `octree` shows, must outlive this.
  svo_ahead(const svo_core_params& p, const numeric::float_to_fixed_errata& conversion, const word_view& octree,
            const std::vector<job_packet>& jobs)
      : batch_(p, conversion, octree), converter_(p.format, conversion), jobs_(jobs) {}

  /// Of the job with this number, the one after that asked for last, or that.
  const svo_walked& walked(std::uint32_t sequence) {
    if (sequence == end_) walk_more();
    return walked_[sequence % walked_.size()];
  }
  /// The job as the job manager makes it.
  traversal_job job(std::uint32_t sequence) const;
  /// What the conversion of the first `jobs` jobs counts.
  numeric::float_to_fixed_stats conversions(std::uint64_t jobs) const;

 private:
  void walk_more();

  svo_batch batch_;
  numeric::float_to_fixed_converter converter_;
  const std::vector<job_packet>& jobs_;
  std::array<svo_walked, 256> walked_;  // of those in [begin_, end_)
  std::size_t begin_ = 0, end_ = 0;
  numeric::float_to_fixed_stats before_;   // of those before begin_,
  numeric::float_to_fixed_stats counted_;  // and before end_
};

}  // namespace rtusim
