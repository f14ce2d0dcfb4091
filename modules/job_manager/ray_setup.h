#pragma once

#include <cstdint>

#include "modules/config/report.h"
#include "modules/formats/packets.h"
#include "modules/formats/triangle_job.h"
#include "modules/numeric/divide.h"
#include "modules/numeric/float_to_fixed.h"

namespace rtusim {

/// How often a ray's words could not be kept.
struct ray_setup_stats {
  std::uint64_t missed_box = 0;       ///< rays that do not meet the scene's box
  std::uint64_t clipped = 0;          ///< rays that begin outside and were moved to the box
  std::uint64_t flat_components = 0;  ///< direction components of 0, whose reciprocal is the greatest word
  numeric::float_to_fixed_stats conversion;

  ray_setup_stats& operator+=(const ray_setup_stats& s);
  void describe(config::report& r) const;
};

/// Makes a triangle core's ray of the host's floats: quantised, clipped to the scene's box, with reciprocal direction (Hanika 2007, sec.
/// 2.1; the hardware for it is ours).
///
/// The origin is cut to grid units, the direction to m bits, +-1.0 to +-(2^(m-1) - 1). A ray from outside enters the box at t = the
/// greatest over the axes of floor(|plane - origin| 2^(m-1) / |dir|), at origin + floor(t dir / 2^(m-1)), which is then held within the
/// box. The reciprocal is trunc(2^(m-1+C) / dir), saturated, from a divider of m+C+1 bits whose operands are 1 and dir.
class ray_setup {
 public:
  /// `corner`: the upper corner of the scene's box in grid units.
  ray_setup(const quantisation& q, const per_axis<std::int64_t>& corner);

  /// All of `job` but its sequence.
  void operator()(const job_packet& packet, ray_setup_stats& stats, triangle_job& job) const;

  /// trunc(2^(m-1+C) / direction), saturated to m+C bits; of 0 the greatest word.
  std::int64_t reciprocal(std::int64_t direction) const;

  /// Bits of the wider of the two dividers: of the reciprocal, m+C+1, and of the clipping's distances, n+m+2.
  unsigned divider_width() const;

 private:
  quantisation q_;
  per_axis<std::int64_t> corner_;
  numeric::float_to_fixed_converter origin_;
  numeric::float_to_fixed_converter direction_;
};

}  // namespace rtusim
