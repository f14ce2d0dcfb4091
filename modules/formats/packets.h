#pragma once

#include <array>
#include <cstdint>

namespace rtusim {

/// One value an axis: x, y, z.
template <class T>
using per_axis = std::array<T, 3>;

/// The job word holds the job id in its low bits and the direction bits `a` above them (Espe 2019, app. C.2).
inline constexpr unsigned job_id_bits = 28;
inline constexpr std::uint32_t job_id_mask = (std::uint32_t{1} << job_id_bits) - 1;

/// A ray as the host sends it: eight little-endian 32-bit words, in this order (Espe 2019, app. C.6).
///
/// To triangle cores the same words are the job id without `a`, origin, direction, and a word that is not read. The origin counts in
/// 2^n grid units from the lower corner of the scene's box; the direction's components lie in [-1, 1].
struct job_packet {
  std::uint32_t job_word = 0;    ///< job id, and the direction bits `a` at 30:28: bit i set where the ray was mirrored on axis i
  per_axis<std::uint32_t> t0{};  ///< entry parameters of the root cube's slabs, binary32 bits; origin
  per_axis<std::uint32_t> t1{};  ///< exit parameters, binary32 bits; direction
  std::uint32_t address = 0;     ///< of the model's root word

  std::uint32_t pixel() const { return job_word & job_id_mask; }
};
static_assert(sizeof(job_packet) == 32);

/// What the jobs of all kinds of cores have.
struct core_job {
  std::uint32_t job_word = 0;
  std::uint32_t sequence = 0;  ///< not in the hardware: the how-manieth job of the run, for the scoreboard
};

/// A ray as the traversal cores see it: fixed point, sign-extended to the host word (Espe 2019, app. C.6).
struct traversal_job : core_job {
  std::uint32_t address = 0;
  per_axis<std::int64_t> t0{};
  per_axis<std::int64_t> t1{};

  unsigned direction_bits() const { return (job_word >> job_id_bits) & 7; }
};

/// No axis: the normal of a core that has not hit anything since reset.
inline constexpr std::int8_t no_axis = -1;

/// What a core found (Espe 2019, app. C.6). `t_hit`, `normal_axis` and `normal_sign` are what the bus carries even on a miss.
/// A triangle core's is the nearest hit: its `t_hit`, and the triangle with the point's place in it; zeros on a miss.
struct traversal_result {
  std::uint32_t job_word = 0;
  std::uint32_t cost = 0;  ///< clocks in all states but IDLE and OUT
  std::int64_t t_hit = 0;  ///< raw fixed point
  std::int64_t u = 0;      ///< raw barycentric coordinates, of vertices 2 and 1
  std::int64_t v = 0;
  std::uint32_t triangle = 0;  ///< number of the triangle hit
  bool hit = false;
  std::int8_t normal_axis = no_axis;  ///< 0, 1, 2 or no_axis
  std::int8_t normal_sign = 0;        ///< +1 or -1 on that axis, 0 without one
  std::uint16_t core = 0;             ///< not in the hardware's packet: which core it came from, as the result multiplexer knows
  std::uint32_t sequence = 0;         ///< not in the hardware: of the job

  std::uint32_t pixel() const { return job_word & job_id_mask; }
};

}  // namespace rtusim
