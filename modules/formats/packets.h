#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace rtusim {

/// Each packet tells its fields to a `Trace`, a waveform say: `add(word, name, bits)` takes one, `widths()` are the `packet_widths`.

/// One value an axis: x, y, z.
template <class T>
using per_axis = std::array<T, 3>;

template <class Trace, class T>
void trace_axes(Trace& to, const std::string& name, const per_axis<T>& values, unsigned bits) {
  for (unsigned i = 0; i < 3; ++i) to.add(values[i], name + "xyz"[i], bits);
}

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

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const job_packet& p) {
  to.add(p.job_word, name + ".job_word");
  if (to.widths().address) to.add(p.address, name + ".address");
  trace_axes(to, name + '.' + to.widths().sent_first + "_float_", p.t0, 32);
  trace_axes(to, name + '.' + to.widths().sent_second + "_float_", p.t1, 32);
}

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

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const traversal_job& j) {
  to.add(j.job_word, name + ".job_word");
  to.add(j.address, name + ".address");
  trace_axes(to, name + ".t0", j.t0, to.widths().t);
  trace_axes(to, name + ".t1", j.t1, to.widths().t);
}

/// No axis: the normal of a core that has not hit anything since reset.
inline constexpr std::int8_t no_axis = -1;

/// What the results of all kinds of cores have (Espe 2019, app. C.6).
struct traversal_result {
  std::uint32_t job_word = 0;
  std::uint32_t cost = 0;      ///< cycles in all states but IDLE and OUT
  std::int64_t t_hit = 0;      ///< raw fixed point
  std::uint32_t sequence = 0;  ///< not in the hardware: of the job
  std::uint16_t core = 0;      ///< not in the hardware's packet: which core it came from, as the result multiplexer knows
  bool hit = false;

  std::uint32_t pixel() const { return job_word & job_id_mask; }
};

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const traversal_result& r) {
  to.add(r.job_word, name + ".job_word");
  to.add(r.hit, name + ".hit");
  to.add(r.t_hit, name + ".t_hit", to.widths().t);
  to.add(r.cost, name + ".cost");
}

/// A voxel core's. `t_hit` and the normal are what the bus carries even on a miss.
struct voxel_result : traversal_result {
  std::int8_t normal_axis = no_axis;  ///< 0, 1, 2 or no_axis
  std::int8_t normal_sign = 0;        ///< +1 or -1 on that axis, 0 without one
};

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const voxel_result& r) {
  trace_fields(to, name, static_cast<const traversal_result&>(r));
  to.add(r.normal_axis, name + ".normal_axis", 3);
  to.add(r.normal_sign, name + ".normal_sign", 2);
}

/// A triangle core's: the nearest hit, its `t_hit` and the triangle with the point's place in it; zeros on a miss.
struct mesh_result : traversal_result {
  std::int64_t u = 0;  ///< raw barycentric coordinates, of vertices 2 and 1
  std::int64_t v = 0;
  std::uint32_t triangle = 0;  ///< number of the triangle hit
};

template <class Trace>
void trace_fields(Trace& to, const std::string& name, const mesh_result& r) {
  trace_fields(to, name, static_cast<const traversal_result&>(r));
  to.add(r.triangle, name + ".triangle");
  to.add(r.u, name + ".u", to.widths().uv);
  to.add(r.v, name + ".v", to.widths().uv);
}

}  // namespace rtusim
