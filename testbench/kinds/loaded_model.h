#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/formats/packets.h"
#include "modules/rtu/design.h"
#include "modules/timing/offer.h"
#include "scenes/rays/camera.h"
#include "scenes/rays/ray_list.h"
#include "scenes/scene.h"
#include "testbench/bench/host_figures.h"
#include "testbench/pictures/frame.h"
#include "testbench/replay/walks.h"

namespace rtusim {

/// What lies in the memories of the cores, and all that only the host's side of their kind knows: how rays become jobs, what a result
/// means.
class loaded_model {
 public:
  virtual ~loaded_model() = default;
  loaded_model(const loaded_model&) = delete;
  loaded_model& operator=(const loaded_model&) = delete;

  /// What lies in the memories.
  virtual const memory_contents& memories() const = 0;
  /// Puts into a design what it leaves to the model.
  virtual void settle(design&) const {}

  /// The jobs of the scene's camera, or of its list of rays, as the driver sends them. `pictured`: each ray of a list needs a pixel.
  /// Errors: input_error for a camera that contradicts itself or sees nothing, a list that can't be used.
  sent_jobs jobs(const design& d, const scene& what, unsigned threads, bool pictured) const;
  /// Those that someone else made.
  sent_jobs jobs(std::vector<job_packet> given) const;

  /// Cycles that cores work on these jobs, waits left out.
  virtual std::uint64_t walk_cycles(const design& d, const std::vector<job_packet>& jobs) const = 0;
  /// Walks rays for a replay; null for a kind of core whose schedule does not follow from its walks.
  virtual std::unique_ptr<ray_walker> walker(const design&) const { return nullptr; }

  /// Where the rays that hit met the model.
  virtual frame::places places(const design& d, const std::vector<job_packet>& jobs, const frame& picture) const = 0;
  /// Whether its frames have surfaces.
  virtual bool has_surfaces() const { return false; }
  /// What keeps a result of the kind in a frame, as it leaves. `jobs`, the frame and this must outlive it.
  using result_keeper = std::function<void(const traversal_result&, std::uint64_t latency_cycles)>;
  virtual result_keeper keeper(const design& d, const std::vector<job_packet>& jobs, frame& picture) const = 0;

  /// Its sizes and checksum, for the record's inputs.
  virtual void describe(nlohmann::ordered_json& inputs) const = 0;
  /// What a caption says of its size, and of the cores: `32 voxels an edge`, `voxel`.
  virtual std::string size_text() const = 0;
  virtual std::string_view cores_word() const = 0;

  /// The log: its first line, and a result's, each with the line's end.
  virtual std::string_view log_header() const = 0;
  virtual void add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& r) const = 0;

 protected:
  loaded_model() = default;
  virtual std::vector<job_packet> camera_jobs(const design& d, const scene& what, unsigned threads, host_figures& host) const = 0;
  virtual std::vector<job_packet> list_jobs(const design& d, const ray_list& rays, unsigned threads, host_figures& host) const = 0;
  /// What became of the model itself.
  virtual host_figures host() const { return {}; }
};

}  // namespace rtusim
