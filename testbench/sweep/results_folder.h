#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "testbench/sweep/sweep_identity.h"

namespace rtusim {

/// Why a point has no result.
struct point_failure {
  std::string reason;
  bool kept = true;  ///< it would fail again: it is run again only if that is asked for
};

/// The folder of a sweep's results: `points/NAME/` and `failed/NAME` of each point, and the tables.
///
/// Whatever is written gets its name when it is whole. Until then it lies under the name `.part-HOST-PID-START-WHAT`, of the process that
/// writes it (`config::process_mark`); the next sweep removes those of processes of this host that are no more. Nothing is written through
/// a link that lies here.
class results_folder {
 public:
  enum class use {
    shared,  ///< several processes, each with other points
    whole,   ///< nobody else
  };

  /// Makes the folder if it is not there. `images`: endings of the pictures that belong to a point. Both must outlive this.
  /// Errors: input_error for what is no folder, can't be written, or holds something else than a sweep's results of this version.
  results_folder(std::filesystem::path out, const std::vector<std::string>& images);
  /// Removes what this process did not finish.
  ~results_folder();
  results_folder(const results_folder&) = delete;
  results_folder& operator=(const results_folder&) = delete;

  /// Waits until nobody else, on any machine, uses the folder in a way that forbids this one, and lays it out. `tell`: says that it waits.
  /// Errors: simulation_error when it is interrupted while it waits.
  void lock(use how, bool tell);
  void unlock();

  const std::filesystem::path& path() const { return out_; }
  std::filesystem::path point(const sweep_task& t) const { return out_ / "points" / t.name; }
  /// Where a point's files are written before it is whole.
  std::filesystem::path part(const sweep_task& t) const { return out_ / "points" / (own_ + t.name); }

  /// A point's statistics file, if its results are there: of this very run, whole, with all pictures that are asked for.
  std::optional<nlohmann::ordered_json> record(const sweep_task& t) const;
  /// Why this very run failed, if it did.
  std::optional<point_failure> failure(const sweep_task& t) const;
  void forget_failure(const sweep_task& t) const;

  /// Files that are put, whole and together, in the place of those of the same names; they are on the disk when this returns.
  struct named_bytes {
    std::string name, bytes;
  };
  void put(const std::vector<named_bytes>& files) const;

 private:
  friend class point_batch;
  void mark() const;
  void clean(const std::filesystem::path& folder, bool own) const;
  std::filesystem::path failed(const sweep_task& t) const { return out_ / "failed" / t.name; }

  std::filesystem::path out_;
  const std::vector<std::string>& images_;
  std::string own_;  // what the names of this process' parts begin with
  int lock_ = -1;
};

/// Points that have ended and are not yet part of the results: they become so together, when what they wrote is on the disk. Waiting for
/// the disk takes at most a twenty-fifth of the time.
class point_batch {
 public:
  explicit point_batch(const results_folder& folder) : folder_(folder) {}

  /// A point whose files lie whole in `part`.
  void done(const sweep_task& t) { done_.push_back(&t); }
  void failed(const sweep_task& t, const point_failure& why);

  /// How long a caller may wait before it calls `commit_if_due` again.
  std::chrono::milliseconds patience() const;
  void commit_if_due();
  void commit();

 private:
  using clock = std::chrono::steady_clock;

  const results_folder& folder_;
  std::vector<const sweep_task*> done_, failed_;
  clock::time_point due_ = clock::now();
};

}  // namespace rtusim
