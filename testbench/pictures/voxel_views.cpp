#include "testbench/pictures/voxel_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace rtusim {
namespace {

using colour = std::array<std::uint8_t, 3>;

constexpr unsigned panel_pixels = 512, gap_pixels = 8;
constexpr colour paper{255, 255, 255}, rule{170, 170, 170}, letter{200, 60, 20}, section{40, 70, 110}, ground{244, 244, 240};
constexpr glm::dvec3 stone{0.78, 0.80, 0.84};

// A square part of the sheet.
class panel {
 public:
  panel(rgb_picture& sheet, unsigned column, unsigned row)
      : sheet_(sheet), left_(gap_pixels + column * (panel_pixels + gap_pixels)), top_(gap_pixels + row * (panel_pixels + gap_pixels)) {}

  void put(unsigned x, unsigned y, const colour& c) {
    std::copy(c.begin(), c.end(), sheet_.samples.begin() + 3 * (std::ptrdiff_t{top_ + y} * sheet_.width + left_ + x));
  }
  // An axis' name, 0 to 2, in a box of 5 x 7 dots whose upper left corner is (x, y).
  void put_name(unsigned axis, unsigned x, unsigned y) {
    constexpr std::uint8_t dots[3][7] = {{0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001},
                                         {0, 0, 0b10001, 0b01010, 0b00100, 0b01000, 0b10000},
                                         {0, 0, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111}};
    for (unsigned j = 0; j < 7 * dot_pixels; ++j)
      for (unsigned i = 0; i < 5 * dot_pixels; ++i)
        if (((dots[axis][j / dot_pixels] >> (4 - i / dot_pixels)) & 1) != 0) put(x + i, y + j, letter);
  }
  static constexpr unsigned dot_pixels = 3, name_width = 5 * dot_pixels, name_height = 7 * dot_pixels;

 private:
  rgb_picture& sheet_;
  unsigned left_, top_;
};

// An axis to the right or upwards: towards its greater end, or away from it.
struct direction {
  unsigned axis;
  bool backwards;

  // The voxels that a pixel covers, `pixel` from the left or from below.
  std::array<unsigned, 2> voxels(unsigned pixel, unsigned resolution) const {
    const unsigned p = backwards ? panel_pixels - 1 - pixel : pixel;
    const unsigned first = p * resolution / panel_pixels, past = (p + 1) * resolution / panel_pixels;
    return {first, std::max(first + 1, past)};
  }
};

void draw_slice(const voxel_grid& grid, unsigned across, const direction& right, const direction& up, panel to) {
  const unsigned resolution = grid.resolution();
  std::array<unsigned, 3> at{};
  at[across] = resolution / 2;
  const auto any_filled = [&](const std::array<unsigned, 2>& us, const std::array<unsigned, 2>& vs) {
    for (at[right.axis] = us[0]; at[right.axis] < us[1]; ++at[right.axis])
      for (at[up.axis] = vs[0]; at[up.axis] < vs[1]; ++at[up.axis])
        if (grid.at(at[0], at[1], at[2])) return true;
    return false;
  };
  for (unsigned y = 0; y < panel_pixels; ++y)
    for (unsigned x = 0; x < panel_pixels; ++x) {
      const bool filled = any_filled(right.voxels(x, resolution), up.voxels(panel_pixels - 1 - y, resolution));
      to.put(x, y, filled ? section : paper);
    }
  constexpr unsigned margin = 6, far_x = panel_pixels - margin - panel::name_width, far_y = panel_pixels - margin - panel::name_height;
  to.put_name(right.axis, right.backwards ? margin : far_x, far_y);
  to.put_name(up.axis, margin, up.backwards ? far_y : margin);
}

// Where a ray meets a voxel first, in its own lengths, and through which face.
struct meeting {
  double depth = std::numeric_limits<double>::infinity();
  glm::dvec3 normal{0.0};

  bool met() const { return depth < std::numeric_limits<double>::infinity(); }
};

// Steps from voxel to voxel (Amanatides and Woo 1987). All in voxels; `way` has length 1 and no zero.
meeting first_met(const voxel_grid& grid, const glm::dvec3& from, const glm::dvec3& way) {
  const auto edge = static_cast<double>(grid.resolution());
  const glm::dvec3 to_lower = (0.0 - from) / way, to_upper = (edge - from) / way;
  const glm::dvec3 enters = glm::min(to_lower, to_upper), leaves = glm::max(to_lower, to_upper);
  int axis = enters.x >= enters.y && enters.x >= enters.z ? 0 : enters.y >= enters.z ? 1 : 2;
  double depth = enters[axis];
  if (depth >= std::min({leaves.x, leaves.y, leaves.z})) return {};
  glm::ivec3 at(glm::clamp(glm::floor(from + way * depth), 0.0, edge - 1));
  const glm::ivec3 step(glm::sign(way));
  const glm::dvec3 a_voxel = 1.0 / glm::abs(way);
  glm::dvec3 next = (glm::dvec3(at) + glm::max(glm::dvec3(step), 0.0) - from) / way;
  for (;;) {
    if (grid.at(static_cast<unsigned>(at.x), static_cast<unsigned>(at.y), static_cast<unsigned>(at.z))) {
      meeting m{depth, {}};
      m.normal[axis] = -step[axis];
      return m;
    }
    axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    at[axis] += step[axis];
    if (at[axis] < 0 || at[axis] >= static_cast<int>(edge)) return {};
    depth = next[axis];
    next[axis] += a_voxel[axis];
  }
}

// A parallel projection of a box of the grid onto a panel.
class voxel_view {
 public:
  voxel_view(const voxel_grid& grid, const glm::dvec3& lower, const glm::dvec3& upper) {
    const auto edge = static_cast<double>(grid.resolution());
    const glm::dvec3 half = 0.5 * (upper - lower) * edge;
    const double reach = 1.04 * std::max({glm::dot(glm::abs(right_), half), glm::dot(glm::abs(up_), half), 1.0});
    a_pixel_ = 2 * reach / panel_pixels;
    const glm::dvec3 corner = 0.5 * (lower + upper) * edge - way_ * (4 * edge) - right_ * reach + up_ * reach;
    met_.reserve(panel_pixels * panel_pixels);
    for (unsigned y = 0; y < panel_pixels; ++y)
      for (unsigned x = 0; x < panel_pixels; ++x)
        met_.push_back(first_met(grid, corner + (right_ * (x + 0.5) - up_ * (y + 0.5)) * a_pixel_, way_));
  }
  void draw(panel to) const {
    const glm::dvec3 light = glm::normalize(glm::dvec3(0.25, 0.9, 0.55));
    for (unsigned y = 0; y < panel_pixels; ++y)
      for (unsigned x = 0; x < panel_pixels; ++x) {
        colour c = ground;
        if (at(x, y).met()) {
          const double lit = 0.3 + 0.7 * std::max(0.0, glm::dot(normal(x, y), light));
          for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(255 * std::sqrt(lit) * stone[k]);
        }
        to.put(x, y, c);
      }
  }

 private:
  const meeting& at(unsigned x, unsigned y) const { return met_[y * panel_pixels + x]; }

  // The face's; where voxels are too small to be seen, that of the plane through what lies around in the picture (least squares).
  glm::dvec3 normal(unsigned x, unsigned y) const {
    constexpr double smooth_below_pixels = 3;
    constexpr int reach = 4;
    constexpr double same_surface_pixels = 3;  // in depth, for each pixel aside
    const meeting& here = at(x, y);
    if (a_pixel_ * smooth_below_pixels < 1) return here.normal;
    const int edge = panel_pixels, cx = static_cast<int>(x), cy = static_cast<int>(y);
    double n = 0, sx = 0, sy = 0, sz = 0, sxx = 0, sxy = 0, syy = 0, sxz = 0, syz = 0;
    for (int j = std::max(-reach, -cy); j <= std::min(reach, edge - 1 - cy); ++j)
      for (int i = std::max(-reach, -cx); i <= std::min(reach, edge - 1 - cx); ++i) {
        const meeting& m = at(static_cast<unsigned>(cx + i), static_cast<unsigned>(cy + j));
        const double z = (m.depth - here.depth) / a_pixel_;
        if (!(std::abs(z) <= same_surface_pixels * (1 + std::max(std::abs(i), std::abs(j))))) continue;
        n += 1, sx += i, sy += j, sz += z, sxx += i * i, sxy += i * j, syy += j * j, sxz += i * z, syz += j * z;
      }
    const double xx = n * sxx - sx * sx, xy = n * sxy - sx * sy, yy = n * syy - sy * sy, xz = n * sxz - sx * sz, yz = n * syz - sy * sz;
    const double determinant = xx * yy - xy * xy;
    if (determinant < 1e-6) return here.normal;
    const glm::dvec3 along_x = right_ + way_ * ((xz * yy - yz * xy) / determinant);
    const glm::dvec3 along_y = up_ - way_ * ((yz * xx - xz * xy) / determinant);
    return glm::normalize(glm::cross(along_x, along_y));
  }

  glm::dvec3 way_ = glm::normalize(glm::dvec3(-0.62, -0.52, -1.0));
  glm::dvec3 right_ = glm::normalize(glm::cross(way_, glm::dvec3(0, 1, 0)));
  glm::dvec3 up_ = glm::cross(right_, way_);
  double a_pixel_ = 1;  // in voxels
  std::vector<meeting> met_;
};

}  // namespace

rgb_picture voxel_views(const voxel_grid& grid, const std::array<double, 3>& lower, const std::array<double, 3>& upper) {
  constexpr unsigned edge = 2 * panel_pixels + 3 * gap_pixels;
  rgb_picture sheet{edge, edge, {}};
  for (unsigned i = 0; i < edge * edge; ++i) sheet.samples.insert(sheet.samples.end(), rule.begin(), rule.end());
  draw_slice(grid, 1, {0, false}, {2, true}, panel(sheet, 0, 0));
  draw_slice(grid, 2, {0, false}, {1, false}, panel(sheet, 0, 1));
  draw_slice(grid, 0, {2, true}, {1, false}, panel(sheet, 1, 1));
  voxel_view(grid, {lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}).draw(panel(sheet, 1, 0));
  return sheet;
}

}  // namespace rtusim
