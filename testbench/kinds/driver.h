#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "modules/formats/quantisation.h"
#include "modules/numeric/fixed_point.h"
#include "scenes/rays/camera.h"
#include "scenes/rays/ray_list.h"
#include "testbench/pictures/frame.h"

/// What the host's driver makes of rays before it sends them.
namespace rtusim {

/// What the driver does as it sends rays to voxel cores (Espe 2019, app. F).
struct voxel_driver_params {
  bool last_sign_only = false;
  bool only_zero_replaced = false;

  void describe(config::section& s);
};

/// What a direction's length is measured by: the sum of its components' magnitudes, or their root of squares.
enum class direction_norm : std::uint8_t { one, two };

/// What the driver does as it sends rays to triangle cores (Hanika 2007, sec. 2.1).
struct triangle_driver_params {
  static config::word_list norm_words() { return {"one", "two"}; }

  direction_norm norm = direction_norm::two;
  bool skip_misses = true;

  void describe(config::section& s);
};

/// How rays for voxel cores are set up.
struct slab_rules {
  bool last_sign_only = false;  ///< the erratum of that name: `a` keeps only the last negative component, in x, y, z order
  /// Parameters are to stay below it in magnitude, which a component near 0 would break; infinity as built, where only 0 itself is
  /// replaced.
  double limit = std::numeric_limits<double>::infinity();

  /// Of a design: the limit is the end of its fixed-point range.
  static slab_rules of(const voxel_driver_params& p, const numeric::fixed_format& format);
};

/// The job packet of one ray, computed as the thesis' driver does (Espe 2019, sec. 4.1 and 6.2.1, app. F `get_initial_params`).
///
/// The direction is normalised; a component of 0 becomes 0.0001; on an axis with a negative component origin and direction are mirrored and
/// the axis' bit is set in `a`; t0 = (-1 - o)/d, t1 = (1 - o)/d for the root cube [-1, 1]^3. All in binary64; only t0 and t1 are rounded,
/// to binary32, to nearest even, beyond its range to an infinity.
/// A component so small that t0 or t1 would reach `rules.limit` is taken as 0 is, but with its sign; where 0.0001 is too small as well, as
/// the least that is not. Where that turns the ray by more than 2^-6, nothing is replaced, and the conversion counts the overflow.
/// A direction of length 0 or that is no number gives NaN words, which the hardware takes like any others.
///
/// \param origin, direction  in world units; the direction of any length
/// \param job_id             bits above the 28th are dropped
/// \param model_address      word address of the model's root
job_packet traversal_parameters(const per_axis<double>& origin, const per_axis<double>& direction, std::uint32_t job_id,
                                const slab_rules& rules, std::uint32_t model_address);

/// The jobs of a whole frame in raster order, job ids are pixel indices. `threads` share the rows; the bytes do not depend on their number.
/// `replaced`, if given, is increased by the number of direction components that are not the ray's own.
/// Errors: as the camera's constructor.
std::vector<job_packet> camera_jobs(const camera::params& p, const raster& f, const slab_rules& rules, std::uint32_t model_address,
                                    unsigned threads = 1, std::uint64_t* replaced = nullptr);
/// The same of listed rays.
std::vector<job_packet> list_jobs(const ray_list& rays, const slab_rules& rules, std::uint32_t model_address, unsigned threads = 1,
                                  std::uint64_t* replaced = nullptr);

/// How world coordinates lie on a triangle model's grid: grid = world * scale + centre, in grid units.
struct grid_mapping {
  double scale = 1;           ///< grid units a world unit
  per_axis<double> centre{};  ///< of the model's box, where the world's origin lies
  per_axis<double> corner{};  ///< the box' upper corner; the lower one is 0
  unsigned n = 30;            ///< packets count in 2^n grid units
};

/// The jobs of a frame for triangle cores. All in binary64 until origin and direction are rounded to binary32; directions are scaled so
/// that their `norm` is 1. With `skip_misses` rays that miss the model's box are not sent.
/// Errors: as the camera's constructor.
std::vector<job_packet> triangle_jobs(const camera::params& p, const raster& f, const grid_mapping& grid, direction_norm norm,
                                      bool skip_misses, unsigned threads = 1);
/// The same of listed rays.
std::vector<job_packet> triangle_jobs(const ray_list& rays, const grid_mapping& grid, direction_norm norm, bool skip_misses,
                                      unsigned threads = 1);

/// Where the rays of hits met something, a pixel's each; of what is nowhere, and of a miss, 0. `point_on_ray`: of a job and a distance.
template <class Point>
std::vector<per_axis<float>> points_of(const std::vector<job_packet>& jobs, const frame& picture, const Point& point_on_ray) {
  const std::vector<frame::pixel>& pixels = picture.pixels();
  std::vector<per_axis<float>> points(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].hit) continue;
    const per_axis<float> point = point_on_ray(jobs[pixels[i].sequence], static_cast<double>(pixels[i].t_hit));
    if (std::isfinite(point[0] + point[1] + point[2])) points[i] = point;
  }
  return points;
}

/// A point on a ray in world units, `distance` from its origin, as far as its packet's words tell.
per_axis<float> point_on_ray(const job_packet& job, double distance);
/// The same of triangle cores' rays.
per_axis<float> point_on_ray(const job_packet& job, const grid_mapping& grid, double distance);

}  // namespace rtusim
