#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "modules/config/schema.h"
#include "modules/formats/svo_image.h"
#include "modules/rtu/design.h"
#include "modules/rtu/rtu.h"
#include "testbench/bench/host_figures.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/run/scene.h"

namespace rtusim {

/// What a run is made of: files and values in the order in which the later win. Empty: not given.
struct run_sources {
  std::filesystem::path scene;
  std::filesystem::path architecture;
  std::vector<std::string> assignments;  ///< KEY=VALUE
  std::filesystem::path model;           ///< in place of the scene's
};

/// All that describes a run: the parameters behind one schema.
struct run_setup {
  design unit;
  surroundings bench;
  scene what;
  config::schema parameters;

  /// Errors: input_error for files and values that can't be used, a value that nothing reads, no model.
  explicit run_setup(const run_sources& from);
  /// A run as a statistics file records it, whose files are named from `folder`. Errors: as above; `place` names the file.
  run_setup(const nlohmann::json& recorded_parameters, const std::string& place, const std::filesystem::path& folder);
  run_setup(const run_setup&) = delete;
  run_setup& operator=(const run_setup&) = delete;

 private:
  void describe();
  void start_files_at(const std::filesystem::path& folder);
  void check() const;
};

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

/// The record of what went in: the model's name, size and checksum, the jobs' checksum.
nlohmann::ordered_json inputs_of(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs);

}  // namespace rtusim
