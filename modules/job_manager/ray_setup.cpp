#include "modules/job_manager/ray_setup.h"

#include <algorithm>

namespace rtusim {
namespace {

__extension__ using int128 = __int128;

/// Bits of an origin before the binary point, which is that of 2^n grid units: eyes this many scenes away, and no more.
constexpr unsigned origin_integer_bits = 16;

}  // namespace

ray_setup::ray_setup(const quantisation& q, const per_axis<std::int64_t>& corner)
    : q_(q), corner_(corner), origin_({origin_integer_bits, q.n}, {}), direction_({2, q.m - 1}, {}) {}

unsigned ray_setup::divider_width() const { return std::max(q_.m + q_.reciprocal_bits + 1, q_.n + q_.m + 2); }

std::int64_t ray_setup::reciprocal(std::int64_t direction) const {
  const unsigned width = q_.m + q_.reciprocal_bits + 1;
  const auto greatest = static_cast<std::int64_t>((std::uint64_t{1} << (width - 2)) - 1);
  if (direction == 0) return greatest;
  const std::int64_t magnitude = direction < 0 ? -direction : direction;
  const numeric::quotient_bits q = numeric::divider(width)(1, magnitude);
  const std::int64_t word = q.err ? greatest : std::min(static_cast<std::int64_t>(q.magnitude), greatest);
  return direction < 0 ? (magnitude == 1 ? -greatest - 1 : -word) : word;
}

void ray_setup::operator()(const job_packet& packet, ray_setup_stats& stats, triangle_job& job) const {
  job.job_word = packet.job_word;
  per_axis<std::int64_t> origin;
  auto& direction = job.ray.direction;
  const std::int64_t one = q_.greatest_direction();
  for (unsigned i = 0; i < 3; ++i) {
    origin[i] = origin_(packet.t0[i], stats.conversion);
    direction[i] = std::clamp(direction_(packet.t1[i], stats.conversion), -one, one);
    job.ray.reciprocal[i] = reciprocal(direction[i]);
    stats.flat_components += direction[i] == 0;
  }
  stats.conversion.conversions += 6;

  // Distances along the ray to where it enters and leaves each axis' slab.
  int128 enter = 0, leave = int128{1} << 100;
  for (unsigned i = 0; i < 3; ++i) {
    const bool down = direction[i] < 0;
    const std::int64_t to_near = down ? origin[i] - corner_[i] : -origin[i];
    const std::int64_t to_far = down ? origin[i] : corner_[i] - origin[i];
    if (direction[i] == 0) {
      if (to_near > 0 || to_far < 0) leave = -1;
      continue;
    }
    const int128 magnitude = down ? -direction[i] : direction[i];
    const auto along = [&](std::int64_t grid_units) { return (int128{grid_units} << (q_.m - 1)) / magnitude; };
    if (to_near > 0) enter = std::max(enter, along(to_near));
    leave = std::min(leave, to_far < 0 ? int128{-1} : along(to_far));
  }
  job.ray.misses_box = enter > leave;
  stats.missed_box += job.ray.misses_box;
  stats.clipped += enter > 0 && !job.ray.misses_box;
  for (unsigned i = 0; i < 3; ++i) {
    const int128 at = origin[i] + (enter * direction[i] >> (q_.m - 1));
    job.ray.position[i] = static_cast<std::int64_t>(std::clamp<int128>(at, 0, corner_[i]));
  }
}

ray_setup_stats& ray_setup_stats::operator+=(const ray_setup_stats& s) {
  missed_box += s.missed_box;
  clipped += s.clipped;
  flat_components += s.flat_components;
  conversion += s.conversion;
  return *this;
}

void ray_setup_stats::describe(config::report& r) const {
  r.number("missed_box", missed_box, "jobs", "rays that do not meet the scene's box");
  r.number("clipped", clipped, "jobs", "rays that begin outside of the box and were moved to it");
  r.number("flat_components", flat_components, "words", "direction components of 0, whose reciprocal is the greatest word");
  r.group("float_to_fixed", [this](config::report& g) { conversion.describe(g); });
}

}  // namespace rtusim
