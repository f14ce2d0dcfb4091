#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/rtu/rtu.h"
#include "testbench/bench/host_figures.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/pictures/frame.h"
#include "testbench/run/run_setup.h"

namespace rtusim {

/// What lies in the memories of the cores, as their kind needs it.
class loaded_model {
 public:
  /// Errors: input_error for a model that can't be used, or that the design can't hold.
  explicit loaded_model(const run_setup& s);

  model_view view() const { return triangles_ ? model_view(triangles_->hierarchy) : model_view(octree_.words); }
  /// Of voxel cores.
  const std::vector<std::uint32_t>& octree() const { return octree_.words; }
  /// Of triangle cores.
  const std::optional<triangle_model>& triangles() const { return triangles_; }

  /// The jobs of the camera, or of a list of rays, as the driver sends them. `pictured`: each ray of a list needs a pixel.
  /// Errors: input_error for a camera that contradicts itself or sees nothing, a list that can't be used.
  sent_jobs jobs(const run_setup& s, unsigned threads, bool pictured) const;
  /// Those that someone else made.
  sent_jobs jobs(std::vector<job_packet> given) const;
  /// Puts into a design what it leaves to the model: `quantisation.edge_shift = "auto"`.
  void settle(run_setup& s) const;

  /// Of voxel cores.
  unsigned voxels_an_edge() const { return 1u << describe(octree_, "model", limits_).levels; }
  /// Where the rays that hit met the model.
  frame::places places(const run_setup& s, const std::vector<job_packet>& jobs, const frame& picture) const;

 private:
  host_figures host() const;

  svo_limits limits_;
  svo_image octree_;
  std::optional<triangle_model> triangles_;
};

}  // namespace rtusim
