#pragma once

#include <filesystem>

#include <fmt/format.h>

#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/timing/offer.h"
#include "testbench/kinds/loaded_model.h"

namespace rtusim {

/// A line for each result in the order of leaving; its columns are those of the cores' kind.
class results_log {
 public:
  /// `model` must outlive this.
  results_log(const std::filesystem::path& file, const loaded_model& model) : out_(file), model_(model) { out_.write(model.log_header()); }

  void add(cycle c, const traversal_result& r) {
    line_.clear();
    model_.add_log_line(line_, c, r);
    out_.write({line_.data(), line_.size()});
  }
  void commit() { out_.commit(); }

 private:
  config::output_file out_;
  const loaded_model& model_;
  fmt::memory_buffer line_;
};

}  // namespace rtusim
