#include "scenes/voxeliser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

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

// Puts a mesh's vertices where they stand in the grid: coordinate c lies in voxel floor(c).
class placement {
 public:
  placement(const mesh& m, unsigned resolution, double fit) : voxels_a_unit_(0.5 * resolution) {
    RTU_CHECK(fit, >, 0.0);
    RTU_CHECK(fit, <=, 1.0);
    const bounding_box box = bounds(m);
    RTU_CHECK(box.half_extent(), >, 0.0);
    scale_ = fit / box.half_extent();
    centre_ = box.centre();
  }
  glm::dvec3 operator()(const glm::dvec3& v) const { return ((v - centre_) * scale_ + 1.0) * voxels_a_unit_; }

 private:
  double voxels_a_unit_, scale_ = 0;
  glm::dvec3 centre_{0.0};
};

// Tells a handler of each hundredth of a work of `steps`, which begins at `from` of the whole and ends at `to`.
class steps_counted {
 public:
  steps_counted(const progress_handler& handler, std::size_t steps, double from, double to)
      : handler_(handler), steps_(steps), from_(from), to_(to) {}
  void done() {
    const std::size_t before = done_++;
    if (handler_ && done_ * 100 / steps_ != before * 100 / steps_)
      handler_(from_ + (to_ - from_) * static_cast<double>(done_) / static_cast<double>(steps_));
  }

 private:
  const progress_handler& handler_;
  std::size_t steps_, done_ = 0;
  double from_, to_;
};

voxel_grid surface(const mesh& m, const placement& place, unsigned resolution, steps_counted progress) {
  voxel_grid grid(resolution);
  for (const auto& corners : m.triangles) {
    triangle t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = place(m.vertices[corners[k]]);
    // Voxel i reaches from i to i + 1, borders included.
    const glm::dvec3 lower = glm::ceil(glm::min(t[0], glm::min(t[1], t[2])) - 1.0);
    const glm::dvec3 upper = glm::floor(glm::max(t[0], glm::max(t[1], t[2])));
    const double most = resolution - 1.0;
    fill_touched(box_test(t), voxel(glm::clamp(lower, 0.0, most)), voxel(glm::clamp(upper, 0.0, most)), grid);
    progress.done();
  }
  return grid;
}

// --- inside ---

__extension__ using int128 = __int128;

constexpr int fraction_bits = 20;
constexpr std::int64_t voxel_edge = std::int64_t{1} << fraction_bits;

// A vertex in units of 2^-20 voxel: 30 bits at most, products of two differences 62.
using grid_point = std::array<std::int64_t, 3>;

// The greatest whole number not above n / d; d > 0.
template <class Int>
constexpr Int floor_of(Int n, Int d) {
  return n / d - Int{n % d < 0};
}

// How many voxels, counted from the border, have their centre at `at` or before it.
constexpr std::int64_t centres_up_to(std::int64_t at) { return (at + voxel_edge / 2) >> fraction_bits; }

// Flips the voxel behind each crossing of a triangle with a line through voxel centres along `axis`.
//
// The lines are thought to be moved by next to nothing, more along u than along v, so that none meets an edge: then two triangles cross
// a line through their common edge once together, and a closed surface an even number of times.
class crossing_counter {
 public:
  crossing_counter(voxel_grid& grid, unsigned axis)
      : grid_(grid), resolution_(grid.resolution()), u_((axis + 1) % 3), v_((axis + 2) % 3), w_(axis) {}

  void count(const std::array<grid_point, 3>& t) {
    const auto [least, most] = std::minmax({t[0][v_], t[1][v_], t[2][v_]});
    const std::int64_t first = std::max<std::int64_t>(centres_up_to(least - 1), 0);
    const std::int64_t past = std::min(centres_up_to(most - 1), resolution_);
    if (first >= past) return;
    // The plane: normal * (point - t[0]) = 0.
    const std::int64_t normal_w = product(t, u_, v_), normal_u = product(t, v_, w_), normal_v = product(t, w_, u_);
    if (normal_w == 0) return;
    const std::int64_t sign = normal_w < 0 ? -1 : 1;
    for (std::int64_t j = first; j < past; ++j) {
      const std::int64_t v = j * voxel_edge + voxel_edge / 2;
      // The row meets two edges, and the triangle between them.
      std::array<std::int64_t, 2> ends{};
      std::size_t met = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const grid_point &a = t[k], &b = t[(k + 1) % 3];
        if ((a[v_] <= v) != (b[v_] <= v)) ends[met++] = a[v_] < b[v_] ? centres_left_of(a, b, v) : centres_left_of(b, a, v);
      }
      for (std::int64_t i = std::min(ends[0], ends[1]); i < std::max(ends[0], ends[1]); ++i) {
        const std::int64_t u = i * voxel_edge + voxel_edge / 2;
        const int128 slope = int128{normal_u} * (u - t[0][u_]) + int128{normal_v} * (v - t[0][v_]);
        const std::int64_t w = t[0][w_] + static_cast<std::int64_t>(floor_of<int128>(-slope * sign, int128{normal_w} * sign));
        flip_behind(i, j, w);
      }
    }
  }

 private:
  // A coordinate of the normal: the cross product of two edges in the plane of two axes.
  static std::int64_t product(const std::array<grid_point, 3>& t, std::size_t a, std::size_t b) {
    return (t[1][a] - t[0][a]) * (t[2][b] - t[0][b]) - (t[1][b] - t[0][b]) * (t[2][a] - t[0][a]);
  }
  // How many centres of the row at v lie on the lesser side of the edge from a up to b.
  std::int64_t centres_left_of(const grid_point& a, const grid_point& b, std::int64_t v) const {
    // The greatest whole distance that is less than that of the edge.
    const std::int64_t less = floor_of((b[u_] - a[u_]) * (v - a[v_]) - 1, b[v_] - a[v_]);
    return std::clamp<std::int64_t>(centres_up_to(a[u_] + less), 0, resolution_);
  }
  void flip_behind(std::int64_t i, std::int64_t j, std::int64_t w) {
    const std::int64_t k = std::max<std::int64_t>(centres_up_to(w), 0);
    if (k >= resolution_) return;
    std::array<unsigned, 3> at{};
    at[u_] = static_cast<unsigned>(i);
    at[v_] = static_cast<unsigned>(j);
    at[w_] = static_cast<unsigned>(k);
    grid_.flip(at[0], at[1], at[2]);
  }

  voxel_grid& grid_;
  std::int64_t resolution_;
  std::size_t u_, v_, w_;
};

// The voxels whose centre is odd, seen along `axis`.
voxel_grid odd_voxels(const mesh& m, const placement& place, unsigned resolution, unsigned axis, steps_counted progress) {
  voxel_grid grid(resolution);
  crossing_counter counter(grid, axis);
  for (const auto& corners : m.triangles) {
    std::array<grid_point, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 p = glm::round(place(m.vertices[corners[k]]) * static_cast<double>(voxel_edge));
      t[k] = {static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
    }
    counter.count(t);
    progress.done();
  }
  grid.accumulate_parity(axis);
  return grid;
}

}  // namespace

voxel_grid voxelise_surface(const mesh& m, unsigned resolution, double fit, const progress_handler& progress) {
  return surface(m, placement(m, resolution, fit), resolution, steps_counted(progress, m.triangles.size(), 0, 1));
}

voxel_grid voxelise_solid(const mesh& m, unsigned resolution, const std::string& place, double fit, const progress_handler& progress) {
  if (const open_edges open = find_open_edges(m); open.count != 0) {
    const auto text = [](const glm::dvec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); };
    throw input_error(place, fmt::format("{} open edges, the first from {} to {}", open.count, text(open.first[0]), text(open.first[1])),
                      "a closed mesh to fill, or surface voxels");
  }
  const placement where(m, resolution, fit);
  const auto steps = [&](int part) { return steps_counted(progress, m.triangles.size(), 0.25 * part, 0.25 * (part + 1)); };
  const voxel_grid touched = surface(m, where, resolution, steps(0));
  voxel_grid filled = odd_voxels(m, where, resolution, 2, steps(1));
  filled |= touched;
  for (unsigned axis = 0; axis < 2; ++axis) {
    voxel_grid other = odd_voxels(m, where, resolution, axis, steps(2 + static_cast<int>(axis)));
    other |= touched;
    if (other != filled) throw input_error(place, "voxels that are inside as seen along one axis alone", "a closed mesh");
  }
  return filled;
}

}  // namespace rtusim
