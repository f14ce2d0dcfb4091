#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/config/section.h"
#include "modules/formats/packets.h"
#include "scenes/rays/raster.h"

namespace rtusim {

/// Rays side by side, for the host's vector unit. Directions have any length.
struct ray_lanes {
  static constexpr std::size_t count = 8;
  double origin[3][count];
  double direction[3][count];
};

/// A camera: one ray through each pixel's centre, row 0 on top. Rays of kind
/// - `thesis` (Espe 2019, app. F `get_inv_proj`, `get_inv_view`, `get_ray`): clip space is OpenGL's, depth -1 to 1. The point at clip
///   depth z is view^-1 (P^-1 (p, z, 1)), divided by its w; a ray starts at the point at z = -1 and points to the one at z = +1. view^-1 =
///   T(position) R^T with R = Rx(0.5 sin(rotation x)) Ry(-rotation y). The two matrices are applied one after the other in binary64:
///   their product would give other last bits;
/// - `look_at`: from `position` to `target`, with `up` upward in the picture; `orbit`: the same from a place on a sphere around `target`.
///   Perspective rays start at the eye, orthographic ones on the plane through it.
class camera {
 public:
  struct params {
    enum class kind : std::uint8_t { thesis, look_at, orbit };
    enum class projection : std::uint8_t { perspective, orthographic };
    static config::word_list kind_words() { return {"thesis", "look_at", "orbit"}; }
    static config::word_list projection_words() { return {"perspective", "orthographic"}; }

    static constexpr double pi = 3.14159265358979323846;
    double vertical_fov_degrees = 75;
    double near = 0.001;
    double far = 100;
    std::array<double, 3> position{-0.5, 0.35, -2.1};
    std::array<double, 3> rotation{pi * 4 / 12, pi * 13 / 12, 0};
    kind which = kind::thesis;
    projection lens = projection::perspective;
    std::array<double, 3> target{0, 0, 0};
    std::array<double, 3> up{0, 1, 0};
    double distance = 3;
    double azimuth_degrees = 30;
    double elevation_degrees = 20;
    double height = 2.2;

    void describe(config::section& s);
  };

  /// Errors: input_error where the values contradict each other: `far` must lie beyond `near`, `rotation` z must be 0, `target` must not
  /// lie in `position`, nor `up` along the view.
  camera(const params& p, const raster& f);

  /// The rays of rows [first, past) in raster order: `take(rays, count, pixel)` with the first `count` lanes' pixels from `pixel` on.
  /// Threads may share a camera.
  template <class Take>
  void rows(unsigned first, unsigned past, Take&& take) const {
    ray_lanes rays;
    for (unsigned y = first; y < past; ++y)
      for (unsigned x = 0; x < width_; x += ray_lanes::count) {
        fill(rays, x, y);
        take(rays, std::min<unsigned>(ray_lanes::count, width_ - x), y * width_ + x);
      }
  }

 private:
  void aim_thesis(const params& p);
  void aim(const params& p, const std::array<double, 3>& eye);

  void fill(ray_lanes& rays, unsigned x, unsigned y) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double* columns = column_part_[axis].data() + x;
      const double row = row_part_[axis][y];
      const double start_depth = depth_part_[0][axis], end_depth = depth_part_[1][axis];
      switch (form_) {
        case form::between_planes: {
          const double start_w = w_[0], end_w = w_[1];
          for (std::size_t i = 0; i < ray_lanes::count; ++i) {
            const double across = columns[i] + row;
            const double start = (across + start_depth) / start_w;
            const double end = (across + end_depth) / end_w;
            rays.origin[axis][i] = start;
            rays.direction[axis][i] = end - start;
          }
          break;
        }
        case form::from_point:
          for (std::size_t i = 0; i < ray_lanes::count; ++i) {
            rays.origin[axis][i] = start_depth;
            rays.direction[axis][i] = (columns[i] + row) + end_depth;
          }
          break;
        case form::parallel:
          for (std::size_t i = 0; i < ray_lanes::count; ++i) {
            rays.origin[axis][i] = (columns[i] + row) + start_depth;
            rays.direction[axis][i] = end_depth;
          }
          break;
      }
    }
  }

  enum class form : std::uint8_t { between_planes, from_point, parallel };

  unsigned width_;
  unsigned height_;
  form form_ = form::between_planes;
  // Between planes: what a point's numerator is the sum of, an axis: (column's part + row's part) + depth's part; and its w. In matrix
  // terms, with V = view^-1, q = P^-1 (p, z, 1): (V0 q.x + V1 q.y) + (V2 q.z + V3 q.w). q.z and q.w depend on z alone.
  // From a point: the eye; column + row + the way to the picture's middle is the direction. Parallel: column + row + eye is the origin.
  per_axis<std::vector<double>> column_part_;     // one value a column, padded to full lanes
  per_axis<std::vector<double>> row_part_;        // one value a row
  std::array<per_axis<double>, 2> depth_part_{};  // at z = -1, z = +1; or the eye, and the way to the middle
  std::array<double, 2> w_{};
};

}  // namespace rtusim
