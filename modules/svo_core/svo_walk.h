#pragma once

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"
#include "modules/svo_core/svo_params.h"

namespace rtusim {

/// Walks a ray to its end at once: the outcome that `svo_machine` reaches clock by clock, with its cost.
class svo_walk {
 public:
  explicit svo_walk(const svo_core_params& p);

  svo_outcome operator()(const traversal_job& job, const word_view& memory) const { return walk_(job, memory, params_); }

 private:
  using function = svo_outcome (*)(const traversal_job&, const word_view&, const svo_core_params&);
  svo_core_params params_;
  function walk_;
};

}  // namespace rtusim
