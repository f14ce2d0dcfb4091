#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "modules/config/report.h"
#include "modules/formats/packets.h"

namespace rtusim {

/// What a mesh loses as it is put on the triangle cores' grid.
struct triangle_losses {
  std::uint64_t dropped = 0;  ///< triangles without area on the grid
  std::uint64_t clamped = 0;  ///< triangles with an edge component beyond what m bits hold
};

/// What becomes of a mesh on its way to triangle cores.
struct triangle_figures {
  triangle_losses losses;
  unsigned edge_shift = 0;  ///< `quantisation.edge_shift`, chosen or given
};

/// What the host does to rays and triangles before a unit has them: what it leaves out, replaces or clamps.
struct host_figures {
  std::uint64_t unsent_rays = 0;          ///< as they miss the model's box, see `driver.skip_misses`
  std::uint64_t replaced_components = 0;  ///< of directions, see `traversal_parameters`
  std::uint64_t duplicate_ids = 0;        ///< jobs whose id an earlier one has
  std::optional<triangle_figures> triangles;

  void describe(config::report& r) const;
};

/// The jobs of a run, and what became of rays and triangles on their way to them.
struct sent_jobs {
  std::vector<job_packet> packets;
  host_figures host;
};

/// How many jobs have the id of an earlier one.
std::uint64_t duplicate_ids(const std::vector<job_packet>& jobs);

}  // namespace rtusim
