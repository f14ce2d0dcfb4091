#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "modules/config/report.h"
#include "modules/formats/packets.h"

namespace rtusim {

/// What becomes of a model on its way into the memories; kinds of cores for which that is not all or nothing derive theirs.
class model_figures {
 public:
  virtual ~model_figures() = default;
  virtual void describe(config::report& r) const = 0;
  /// Appends what was lost, a sentence each.
  virtual void warn(std::vector<std::string>& all) const = 0;
};

/// What the host does to rays and models before a unit has them: what it leaves out, replaces or clamps.
struct host_figures {
  std::uint64_t unsent_rays = 0;               ///< as they miss the model's box, see `driver.skip_misses`
  std::uint64_t replaced_components = 0;       ///< of directions, see `traversal_parameters`
  std::uint64_t duplicate_ids = 0;             ///< jobs whose id an earlier one has
  std::shared_ptr<const model_figures> model;  ///< null where there are none

  void describe(config::report& r) const;
};

/// The jobs of a run, and what became of rays and models on their way to them.
struct sent_jobs {
  std::vector<job_packet> packets;
  host_figures host;
};

/// How many jobs have the id of an earlier one.
std::uint64_t duplicate_ids(const std::vector<job_packet>& jobs);

}  // namespace rtusim
