#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "modules/svo_core/svo_kind.h"
#include "modules/svo_core/svo_walk.h"
#include "testbench/replay/walks.h"

namespace rtusim {

/// Converts jobs and walks them through an octree, which must outlive this.
class svo_walker final : public ray_walker {
 public:
  svo_walker(const svo_kind& kind, const std::vector<std::uint32_t>& octree)
      : walk_(kind.core_with_format()), converter_(kind.format, kind.conversion), words_(view_of(octree, kind.memory_)) {}

  void operator()(const job_packet* jobs, std::size_t count, walked_ray* to, numeric::float_to_fixed_stats& conversion) const override;
  std::unique_ptr<replaying::job_schedule> schedule(const design& d, const surroundings& s, const walked_rays& walked,
                                                    const result_handler& handler) const override;

 private:
  svo_walk walk_;
  numeric::float_to_fixed_converter converter_;
  word_view words_;
};

}  // namespace rtusim
