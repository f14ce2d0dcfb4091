#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "modules/config/error.h"
#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim {

/// The deepest stack a core can be given: 2^21 voxels a side.
inline constexpr unsigned most_stack_frames = 20;

/// States of the traversal core (Espe 2019, sec. 7.2.4 and app. C.4), coded as in its RTL.
enum class svo_state : std::uint8_t { idle, init, eval, next, push, pop, out };
inline constexpr std::string_view svo_state_words[] = {"IDLE", "INIT", "EVAL", "NEXT", "PUSH", "POP", "OUT"};

struct svo_core_params {
  unsigned stack_depth = 11;
  bool far_popcount = false;
  bool negative_t = false;
  bool positive_normals = false;
  bool tm_wrap = false;
  bool stale_miss = false;
  numeric::fixed_format format;  ///< of the section `fixed_point`

  void describe(config::section& s);
};

/// What a ray's traversal comes to.
struct svo_outcome {
  std::uint32_t job_word = 0;
  std::uint32_t cost = 0;  ///< cycles in INIT, EVAL, NEXT, PUSH and POP
  std::uint32_t pushes = 0;
  std::uint32_t entry = 0;  ///< word of the cube whose child was looked at last
  std::int64_t t_hit = 0;   ///< of a hit
  bool hit = false;
  bool overflow = false;       ///< the stack has no room for a frame: no outcome
  std::uint8_t child = 0;      ///< the child that was looked at last: bit i set for the upper half on axis i, mirrored by `a`
  std::uint8_t depth = 0;      ///< frames on the stack at the end
  std::int8_t axis = no_axis;  ///< of a hit
};

/// Cycles by state of a whole traversal. They follow from its cost, its pushes and how it ended.
struct svo_visits {
  std::uint64_t init = 0, eval = 0, next = 0, push = 0, pop = 0;
  svo_visits& operator+=(const svo_visits& v);
};
svo_visits visits_of(const svo_outcome& o);
/// The same over `rays` traversals, from the sums of their figures; `ends`: of how many the ray left the root cube after an EVAL.
svo_visits visits_of_sums(std::uint64_t rays, std::uint64_t cost, std::uint64_t pushes, std::uint64_t depth, std::uint64_t ends);

/// The fault of a stack that is too small for a ray; `core`: the instance's name.
simulation_error svo_stack_overflow(const std::string& core, unsigned stack_depth, std::uint32_t sequence, std::uint32_t job_word,
                                    std::uint64_t cycle);

/// The result bus of a core: what it carries is kept from hit to hit where misses are `stale_miss`.
struct svo_result_registers {
  std::int64_t t_hit = 0;
  std::int8_t axis = no_axis;
  std::int8_t sign = 0;

  /// Takes a traversal's outcome over.
  void take(const svo_outcome& o, unsigned direction_bits, const svo_core_params& p);
};

}  // namespace rtusim
