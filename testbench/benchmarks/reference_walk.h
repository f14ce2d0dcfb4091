#pragma once

#include <cstdint>

#include "modules/formats/packets.h"
#include "modules/formats/word_view.h"

namespace rtusim {

/// The yardstick: the traversal as built (Espe 2019, sec. 4.1), written down plainly for 32-bit words, no widths, no switches, no
/// counts but the cost.
struct reference_outcome {
  bool hit = false;
  std::int32_t t_hit = 0;
  int axis = -1;
  std::uint32_t cost = 0;
};
reference_outcome reference_walk(const traversal_job& job, const word_view& memory);

}  // namespace rtusim
