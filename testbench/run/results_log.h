#pragma once

#include <filesystem>

#include <fmt/format.h>

#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/timing/offer.h"
#include "testbench/kinds/triangle_model.h"

namespace rtusim {

/// A line for each result in the order of leaving: cycle, core, job_id (the whole job word), hit, t_hit and normal_axis (0 and -1 on a
/// miss), cost, and what the bus carries: raw_t_hit, raw_normal_axis. Of triangle cores: cycle, core, job_id, hit, tri (the mesh's face, -1
/// on a miss), t, u, v (raw words, 0 on a miss), clocks.
class results_log {
 public:
  /// `triangles`: those that the cores trace, if they do; it must outlive this.
  results_log(const std::filesystem::path& file, const triangle_model* triangles) : out_(file), triangles_(triangles) {
    out_.write(triangles != nullptr ? "cycle,core,job_id,hit,tri,t,u,v,clocks\n"
                         : "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n");
  }

  void add(cycle c, const traversal_result& r) {
    line_.clear();
    if (triangles_ != nullptr)
      fmt::format_to(std::back_inserter(line_), "{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit),
                     r.hit ? std::int64_t{triangles_->faces[r.triangle]} : -1, r.t_hit, r.u, r.v, r.cost);
    else
      add_voxel(c, r);
    out_.write({line_.data(), line_.size()});
  }
  void commit() { out_.commit(); }

 private:
  void add_voxel(cycle c, const traversal_result& r) {
    const int axis = r.normal_axis;
    fmt::format_to(std::back_inserter(line_), "{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit),
                   r.hit ? r.t_hit : 0, r.hit ? axis : -1, r.cost, r.t_hit, axis);
  }

  config::output_file out_;
  const triangle_model* triangles_;
  fmt::memory_buffer line_;
};

}  // namespace rtusim
