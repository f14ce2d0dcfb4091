#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/loaded_model.h"

namespace rtusim {

/// An octree for voxel cores.
///
/// Log: cycle, core, job_id (the whole job word), hit, t_hit and normal_axis (0 and -1 on a miss), cost, and what the bus carries:
/// raw_t_hit, raw_normal_axis.
class svo_model final : public loaded_model {
 public:
  /// Errors: those of `load_octree`.
  svo_model(const design& d, const scene& what, const voxel_driver_params& driver);

  const std::vector<std::uint32_t>& octree() const { return octree_.words; }
  unsigned voxels_an_edge() const;

  const memory_contents& memories() const override { return contents_; }
  std::uint64_t walk_cycles(const design& d, const std::vector<job_packet>& jobs) const override;
  std::unique_ptr<ray_walker> walker(const design& d) const override;
  result_keeper keeper(const design& d, const std::vector<job_packet>& jobs, frame& picture) const override;
  frame::places places(const design& d, const std::vector<job_packet>& jobs, const frame& picture) const override;
  void describe(nlohmann::ordered_json& inputs) const override;
  std::string size_text() const override;
  std::string_view cores_word() const override { return "voxel"; }
  std::string_view log_header() const override { return "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n"; }
  void add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& r) const override;

 private:
  std::vector<job_packet> camera_jobs(const design& d, const scene& what, unsigned threads, host_figures& host) const override;
  std::vector<job_packet> list_jobs(const design& d, const ray_list& rays, unsigned threads, host_figures& host) const override;

  voxel_driver_params driver_;
  svo_limits limits_;
  svo_image octree_;
  svo_contents contents_;
};

}  // namespace rtusim
