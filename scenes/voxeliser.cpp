#include "scenes/voxeliser.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

using triangle = std::array<glm::dvec3, 3>;
using voxel = glm::ivec3;

// Triangle against axis-parallel box by the 13 possible separating axes (Akenine-Moller 2001). Borders count.
class box_test {
 public:
  explicit box_test(const triangle& t)
      : corners_(t), edges_{t[1] - t[0], t[2] - t[1], t[0] - t[2]}, normal_(glm::cross(edges_[0], edges_[1])) {}

  // The box: its centre and half edges.
  bool touches(const glm::dvec3& centre, const glm::dvec3& half) const {
    const triangle v{corners_[0] - centre, corners_[1] - centre, corners_[2] - centre};
    for (int k = 0; k < 3; ++k)
      if (std::min({v[0][k], v[1][k], v[2][k]}) > half[k] || std::max({v[0][k], v[1][k], v[2][k]}) < -half[k]) return false;
    if (std::abs(glm::dot(normal_, v[0])) > glm::dot(glm::abs(normal_), half)) return false;
    for (const glm::dvec3& e : edges_) {
      // The cross products of the edge with the axes.
      if (separates({0, -e.z, e.y}, v, half) || separates({e.z, 0, -e.x}, v, half) || separates({-e.y, e.x, 0}, v, half)) return false;
    }
    return true;
  }

 private:
  static bool separates(const glm::dvec3& axis, const triangle& v, const glm::dvec3& half) {
    const double a = glm::dot(axis, v[0]), b = glm::dot(axis, v[1]), c = glm::dot(axis, v[2]);
    const double r = glm::dot(glm::abs(axis), half);
    return std::min({a, b, c}) > r || std::max({a, b, c}) < -r;
  }

  triangle corners_;
  std::array<glm::dvec3, 3> edges_;
  glm::dvec3 normal_;
};

// Fills the voxels from `first` to `last` that the triangle touches, halving the box where it is longest.
void fill_touched(const box_test& test, const voxel& first, const voxel& last, voxel_grid& grid) {
  // Boxes of several voxels are grown a little, so that rounding never hides a voxel that touches by itself.
  constexpr double slack = 1e-6;
  const bool single = first == last;
  const glm::dvec3 half = glm::dvec3(last - first + 1) * 0.5;
  if (!test.touches(glm::dvec3(first) + half, single ? half : half + slack)) return;
  if (single) {
    grid.fill(static_cast<unsigned>(first.x), static_cast<unsigned>(first.y), static_cast<unsigned>(first.z));
    return;
  }
  const voxel size = last - first;
  const int k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  voxel lower_last = last, upper_first = first;
  lower_last[k] = first[k] + size[k] / 2;
  upper_first[k] = lower_last[k] + 1;
  fill_touched(test, first, lower_last, grid);
  fill_touched(test, upper_first, last, grid);
}

}  // namespace

voxel_grid voxelise_surface(const mesh& m, unsigned resolution, double fit) {
  RTU_CHECK(fit, >, 0.0);
  RTU_CHECK(fit, <=, 1.0);
  const bounding_box box = bounds(m);
  RTU_CHECK(box.half_extent(), >, 0.0);
  const double scale = fit / box.half_extent();
  const glm::dvec3 centre = box.centre();
  const double voxels_a_unit = 0.5 * resolution;

  voxel_grid grid(resolution);
  for (const auto& corners : m.triangles) {
    triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = ((m.vertices[corners[k]] - centre) * scale + 1.0) * voxels_a_unit;
    // Voxel i reaches from i to i + 1, borders included.
    const glm::dvec3 lower = glm::ceil(glm::min(t[0], glm::min(t[1], t[2])) - 1.0);
    const glm::dvec3 upper = glm::floor(glm::max(t[0], glm::max(t[1], t[2])));
    const double most = resolution - 1.0;
    fill_touched(box_test(t), voxel(glm::clamp(lower, 0.0, most)), voxel(glm::clamp(upper, 0.0, most)), grid);
  }
  return grid;
}

}  // namespace rtusim
