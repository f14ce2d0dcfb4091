#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "testbench/bench/run_figures.h"
#include "testbench/kinds/loaded_model.h"
#include "testbench/pictures/frame.h"
#include "testbench/pictures/pictures.h"
#include "testbench/run/run_setup.h"

namespace rtusim {

/// What a run's pictures show, gathered as results leave.
class run_pictures {
 public:
  /// `jobs`: of the run; until `finish` they and the others must stay. `from_driver`: the driver chose them, so that other pixels are
  /// misses.
  run_pictures(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs, bool from_driver);

  void store(const traversal_result& r, std::uint64_t latency_cycles) { keep_(r, latency_cycles); }
  const frame& picture() const { return picture_; }

  /// The run is over. `places`: one of the pictures shows where rays met the model.
  void finish(const run_figures& figures, bool places);
  /// Errors: as `write_picture`.
  void write(const std::filesystem::path& file) const { write_picture(file, picture_, kind_of(file), text_); }

 private:
  const run_setup& setup_;
  const loaded_model& model_;
  const std::vector<job_packet>& jobs_;
  frame picture_;
  loaded_model::result_keeper keep_;
  picture_text text_;
};

}  // namespace rtusim
