#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/loaded_model.h"
#include "testbench/kinds/triangle_model.h"

namespace rtusim {

/// A hierarchy over a mesh for triangle cores.
///
/// Log: cycle, core, job_id, hit, tri (the mesh's face, -1 on a miss), t, u, v (raw words, 0 on a miss), clocks.
class bih_model final : public loaded_model {
 public:
  /// Errors: those of `load_triangles`.
  bih_model(const design& d, const scene& what, const triangle_driver_params& driver, unsigned leaf_triangles);

  const triangle_model& triangles() const { return model_; }

  const memory_contents& memories() const override { return contents_; }
  void settle(design& d) const override;
  std::uint64_t walk_cycles(const design& d, const std::vector<job_packet>& jobs) const override;
  std::unique_ptr<ray_walker> walker(const design& d) const override;
  frame::places places(const design& d, const std::vector<job_packet>& jobs, const frame& picture) const override;
  bool has_surfaces() const override { return true; }
  result_keeper keeper(const design& d, const std::vector<job_packet>& jobs, frame& picture) const override;
  void describe(nlohmann::ordered_json& inputs) const override;
  std::string size_text() const override;
  std::string_view cores_word() const override { return "triangle"; }
  std::string_view log_header() const override { return "cycle,core,job_id,hit,tri,t,u,v,clocks\n"; }
  void add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& r) const override;

 private:
  std::vector<job_packet> camera_jobs(const design& d, const scene& what, unsigned threads, host_figures& host) const override;
  std::vector<job_packet> list_jobs(const design& d, const ray_list& rays, unsigned threads, host_figures& host) const override;
  host_figures host() const override;

  triangle_driver_params driver_;
  triangle_model model_;
  bih_contents contents_;
};

}  // namespace rtusim
