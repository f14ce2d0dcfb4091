#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "scenes/rays/camera.h"

namespace rtusim {

/// Rays of a file in place of a camera's. Ray i belongs to pixel i. Zipped by gzip or not, a file is
/// - `.csv`: a header line that names ox, oy, oz (origin), dx, dy, dz (direction), in any order and among other columns; a ray a line;
/// - `.bin`: six little-endian binary32 a ray, in that order.
/// Components are binary32, in world units, a direction's length is not read. What is no number or infinite is passed on: the hardware
/// takes any word.
class ray_list {
 public:
  struct ray {
    std::array<float, 3> origin, direction;
  };
  static_assert(sizeof(ray) == 24);

  ray_list() = default;
  explicit ray_list(std::vector<ray> rays) : rays_(std::move(rays)) {}
  /// Errors: input_error for a file that can't be read, is neither `.csv` nor `.bin`, holds no rays, lacks a column, ends within a ray, or
  /// has a field that is no binary32; with its line.
  explicit ray_list(const std::filesystem::path& file);

  std::size_t size() const { return rays_.size(); }

  /// As of a camera, in rows of one `ray_lanes` each.
  unsigned height() const { return static_cast<unsigned>((rays_.size() + ray_lanes::count - 1) / ray_lanes::count); }
  template <class Take>
  void rows(unsigned first, unsigned past, Take&& take) const {
    for (unsigned row = first; row < past; ++row) {
      const std::size_t begin = std::size_t{row} * ray_lanes::count;
      const auto count = static_cast<unsigned>(std::min(ray_lanes::count, rays_.size() - begin));
      ray_lanes lanes{};
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          lanes.origin[axis][i] = static_cast<double>(rays_[begin + i].origin[axis]);
          lanes.direction[axis][i] = static_cast<double>(rays_[begin + i].direction[axis]);
        }
      take(lanes, count, static_cast<std::uint32_t>(begin));
    }
  }

 private:
  std::vector<ray> rays_;
};

}  // namespace rtusim
