#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "testbench/frame.h"

namespace rtusim {

/// The job packet of one ray, computed as the thesis' driver does (Espe 2019, sec. 4.1 and 6.2.1, app. F `get_initial_params`).
///
/// The direction is normalised; a component that is exactly 0 becomes 0.0001; on an axis with a negative component origin and
/// direction are mirrored and the axis' bit is set in `a`; t0 = (-1 - o)/d, t1 = (1 - o)/d for the root cube [-1, 1]^3. All in
/// binary64; only t0 and t1 are rounded, to binary32, to nearest even, beyond its range to an infinity.
/// A direction of length 0 or that is no number gives NaN words, which the hardware takes like any others.
///
/// \param origin, direction  in world units; the direction of any length
/// \param job_id             bits above the 28th are dropped
/// \param last_sign_only     the erratum of that name: `a` keeps only the last negative component, in x, y, z order
/// \param model_address      word address of the model's root
job_packet traversal_parameters(const per_axis<double>& origin, const per_axis<double>& direction, std::uint32_t job_id,
                                bool last_sign_only, std::uint32_t model_address);

/// The camera of the thesis (Espe 2019, app. F `get_inv_proj`, `get_inv_view`, `get_ray`), one ray through each pixel's centre.
///
/// Clip space is OpenGL's, depth -1 to 1. The point at clip depth z is view^-1 (P^-1 (p, z, 1)), divided by its w; a ray starts at
/// the point at z = -1 and points to the one at z = +1. view^-1 = T(position) R^T with R = Rx(0.5 sin(rotation x)) Ry(-rotation y).
/// The two matrices are applied one after the other in binary64: their product would give other last bits.
class camera {
 public:
  struct params {
    static constexpr double pi = 3.14159265358979323846;
    double vertical_fov_degrees = 75;
    double near = 0.001;
    double far = 100;
    std::array<double, 3> position{-0.5, 0.35, -2.1};
    std::array<double, 3> rotation{pi * 4 / 12, pi * 13 / 12, 0};
    void describe(config::section& s);
  };

  /// Errors: input_error where the values contradict each other: `far` must lie beyond `near`, `rotation` z must be 0.
  camera(const params& p, const frame::params& f);

  /// The jobs of rows [first, past) in raster order to `out`, which has room for (past - first) * width packets. Job ids are
  /// pixel indices. Threads may share a camera, each with rows of its own.
  void rows(unsigned first, unsigned past, bool last_sign_only, std::uint32_t model_address, job_packet* out) const;

 private:
  static constexpr unsigned lanes = 8;  // rays computed together, for the host's vector unit

  unsigned width_;
  unsigned height_;
  // What a point's numerator is the sum of, an axis: (column's part + row's part) + depth's part; and its w. In matrix terms, with
  // V = view^-1, q = P^-1 (p, z, 1): (V0 q.x + V1 q.y) + (V2 q.z + V3 q.w). q.z and q.w depend on z alone.
  per_axis<std::vector<double>> column_part_;  // one value a column, padded to full lanes
  per_axis<std::vector<double>> row_part_;     // one value a row
  std::array<per_axis<double>, 2> depth_part_{};  // at z = -1, z = +1
  std::array<double, 2> w_{};
};

/// The jobs of a whole frame in raster order. `threads` share the rows; the bytes do not depend on their number.
/// Errors: as the camera's constructor.
std::vector<job_packet> camera_jobs(const camera::params& p, const frame::params& f, bool last_sign_only, std::uint32_t model_address,
                                    unsigned threads = 1);

}  // namespace rtusim
