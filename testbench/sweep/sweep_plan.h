#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "testbench/run/run_setup.h"

namespace rtusim {

/// What a sweep file asks for: designs and scenes that are crossed, and what is kept of each run.
///
///     [sweep]
///     scenes = ["../../scenes/dragon.toml"]                   # paths start at the file's folder
///     architectures = ["../architectures/espe2019.toml"]      # may be left out: the default design
///     constraints = ["rtu.cores <= 16 || is(\"scheduler.policy=round_robin\")"]
///     record = ["total_cycles", "waits"]                      # figures, or groups of them, of a statistics file
///     images = ["png", "cost.png"]                            # endings of `run --image`
///     limit = 10000                                           # points
///     [set]
///     "source.valid" = "paced"
///     [axes]                                                  # crossed
///     "rtu.cores" = {from = 1, to = 64}                       # also step = 2, or factor = 2
///     "scheduler.policy" = ["round_robin", "first_available"]
///     "camera.position" = ["default"]                         # takes back what a scene or an architecture gives
///     [[in_step]]                                             # values that go together
///     "frame.width" = [320, 640]
///     "frame.height" = [180, 360]
///
/// Points are numbered in this order: scenes, architectures, axes as the file names them, the last turning fastest.
class sweep_plan {
 public:
  /// A parameter's value: what `--set` takes, what a table shows, and the number, word, truth or array that it is.
  struct value {
    std::string assignment;
    std::string shown;
    nlohmann::ordered_json typed;
  };
  struct point {
    std::size_t scene = 0;
    std::size_t architecture = 0;
    std::vector<const value*> values;  ///< one of each axis
  };

  /// Errors: input_error with file, line and what was expected, for a file that is none, an axis without values or with a key that is no
  /// parameter's, values that do not go in step, more points than `limit`.
  explicit sweep_plan(const std::filesystem::path& file);

  /// The points that the constraints allow, in order.
  const std::vector<point>& points() const { return points_; }
  std::size_t left_out() const { return left_out_; }
  const std::vector<std::string>& axes() const { return keys_; }
  const std::vector<std::string>& record() const { return record_; }
  const std::vector<std::string>& images() const { return images_; }
  std::filesystem::path scene(const point& p) const { return place_of(scenes_[p.scene]); }
  /// Empty for the default design.
  std::filesystem::path architecture(const point& p) const { return place_of(architectures_[p.architecture]); }
  /// As the sweep file has them.
  const std::string& scene_name(const point& p) const { return scenes_[p.scene]; }
  const std::string& architecture_name(const point& p) const { return architectures_[p.architecture]; }
  /// A text in which files are named from the sweep file's folder, whatever the current one.
  std::string named_as_written(std::string text) const;

  /// The run of a point. Errors: those of `run_setup`.
  std::unique_ptr<run_setup> setup(const point& p) const;

 private:
  struct axis_group {
    std::vector<std::vector<value>> rows;  // one value of each key
  };

  std::filesystem::path place_of(const std::string& file) const { return file.empty() ? std::filesystem::path() : folder_ / file; }

  std::filesystem::path folder_;  // of the sweep file, in full
  std::vector<std::string> scenes_, architectures_;
  std::vector<std::string> fixed_;
  std::vector<std::string> keys_;
  std::vector<axis_group> groups_;
  std::vector<std::string> constraints_, record_, images_;
  std::vector<point> points_;
  std::size_t left_out_ = 0;

  friend class sweep_reader;
};

}  // namespace rtusim
