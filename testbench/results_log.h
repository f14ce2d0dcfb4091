#pragma once

#include <filesystem>

#include <fmt/format.h>

#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/timing/offer.h"

namespace rtusim {

/// A line for each result in the order of leaving: cycle, core, job_id (the whole job word), hit, t_hit and normal_axis (0 and -1 on a
/// miss), cost, and what the bus carries: raw_t_hit, raw_normal_axis. Of triangle cores: cycle, core, job_id, hit, tri (-1 on a miss),
/// t, u, v (raw words, 0 on a miss), clocks.
class results_log {
 public:
  results_log(const std::filesystem::path& file, bool triangles) : out_(file), triangles_(triangles) {
    out_.write(triangles ? "cycle,core,job_id,hit,tri,t,u,v,clocks\n"
                         : "cycle,core,job_id,hit,t_hit,normal_axis,cost,raw_t_hit,raw_normal_axis\n");
  }

  void add(cycle c, const traversal_result& r) {
    line_.clear();
    if (triangles_)
      fmt::format_to(std::back_inserter(line_), "{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit),
                     r.hit ? static_cast<std::int64_t>(r.triangle) : -1, r.t_hit, r.u, r.v, r.cost);
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
  bool triangles_;
  fmt::memory_buffer line_;
};

}  // namespace rtusim
