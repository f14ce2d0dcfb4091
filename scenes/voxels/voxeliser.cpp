#include "scenes/voxels/voxeliser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

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

using grid_triangle = std::array<grid_point, 3>;

// A mesh's triangles, those without area too, with their vertices on whole numbers.
class triangles_on_grid {
 public:
  triangles_on_grid(const mesh& m, const placement& place) : mesh_(m), place_(place) {}

  std::size_t size() const { return mesh_.all_triangles(); }
  grid_triangle operator[](std::size_t n) const {
    grid_triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 p = glm::round(place_(mesh_.vertices[mesh_.triangle(n)[k]]) * static_cast<double>(voxel_edge));
      t[k] = {static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y), static_cast<std::int64_t>(p.z)};
    }
    return t;
  }

 private:
  const mesh& mesh_;
  const placement& place_;
};

// The rows of voxel centres that a triangle meets: the first, and the one past the last.
struct row_range {
  row_range(const grid_triangle& t, std::size_t axis, std::int64_t rows) {
    const auto [least, most] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    first = std::max<std::int64_t>(centres_up_to(least - 1), 0);
    past = std::min(centres_up_to(most - 1), rows);
  }
  std::int64_t first, past;
};

// How often triangles wind around the voxel centres of a layer of blocks, seen along `axis`: at each crossing with the line through a
// column of centres it changes by one, up or down as the triangle faces.
//
// The lines are thought to be moved by next to nothing, more along u than along v, so that none meets an edge: then two triangles cross
// a line through their common edge once together, and a closed surface as often one way as the other.
class winding_layer {
 public:
  winding_layer(unsigned resolution, unsigned axis)
      : resolution_(resolution),
        edge_(std::max(resolution / 4, 1U)),
        u_((axis + 1) % 3),
        v_((axis + 2) % 3),
        w_(axis),
        changes_(std::size_t{edge_} * edge_),
        is_crossed_(changes_.size()) {
    for (unsigned place = 0; place < 64; ++place) bits_[place] = std::uint64_t{1} << number_of(place / 4 % 4, place / 16, place % 4);
  }

  std::size_t row_axis() const { return v_; }

  // Counts a triangle's crossings in layer number `layer`.
  void count(const grid_triangle& t, unsigned layer) {
    const row_range rows(t, v_, resolution_);
    const std::int64_t first = std::max<std::int64_t>(rows.first, 4 * layer), past = std::min<std::int64_t>(rows.past, 4 * layer + 4);
    if (first >= past) return;
    // The plane: normal * (point - t[0]) = 0.
    const std::int64_t normal_w = product(t, u_, v_), normal_u = product(t, v_, w_), normal_v = product(t, w_, u_);
    if (normal_w == 0) return;
    const std::int32_t sign = normal_w < 0 ? -1 : 1;
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
        change_behind(i, j, w, sign);
      }
    }
  }

  // Hands each block of the layer to `take(number, bits)`, bits set where the winding number is not 0, and clears the layer.
  template <class Take>
  void hand_over(unsigned layer, Take&& take) {
    for (unsigned i = 0; i < edge_; ++i) {
      std::array<std::int32_t, 16> winding{};  // of each of a block's columns
      std::uint64_t inside = 0;                // of a block that nothing crosses
      for (unsigned k = 0; k < edge_; ++k) {
        const std::size_t at = std::size_t{i} * edge_ + k;
        const std::uint32_t number = number_of(i, layer, k);
        if (is_crossed_[at] == 0) {
          take(number, inside & present());
          continue;
        }
        take(number, add(changes_[at], winding) & present());
        changes_[at] = {};
        is_crossed_[at] = 0;
        block_of_changes none{};
        inside = add(none, winding);
      }
    }
  }

 private:
  using block_of_changes = std::array<std::int32_t, 64>;  // behind each place (v, u, w), w fastest

  // A coordinate of the normal: the cross product of two edges in the plane of two axes.
  static std::int64_t product(const grid_triangle& t, std::size_t a, std::size_t b) {
    return (t[1][a] - t[0][a]) * (t[2][b] - t[0][b]) - (t[1][b] - t[0][b]) * (t[2][a] - t[0][a]);
  }
  // How many centres of the row at v lie on the lesser side of the edge from a up to b.
  std::int64_t centres_left_of(const grid_point& a, const grid_point& b, std::int64_t v) const {
    // The greatest whole distance that is less than that of the edge.
    const std::int64_t less = floor_of((b[u_] - a[u_]) * (v - a[v_]) - 1, b[v_] - a[v_]);
    return std::clamp<std::int64_t>(centres_up_to(a[u_] + less), 0, resolution_);
  }
  void change_behind(std::int64_t i, std::int64_t j, std::int64_t w, std::int32_t by) {
    const std::int64_t k = std::max<std::int64_t>(centres_up_to(w), 0);
    if (k >= resolution_) return;
    const auto at = static_cast<std::size_t>(i / 4 * edge_ + k / 4);
    changes_[at][static_cast<std::size_t>(j % 4 * 16 + i % 4 * 4 + k % 4)] += by;
    is_crossed_[at] = 1;
  }
  // Adds a block's changes to the winding of its columns; the bits are set where it is not 0.
  std::uint64_t add(const block_of_changes& changes, std::array<std::int32_t, 16>& winding) const {
    std::uint64_t bits = 0;
    for (std::size_t place = 0; place < 64; ++place)
      if ((winding[place / 4] += changes[place]) != 0) bits |= bits_[place];
    return bits;
  }
  std::uint32_t number_of(unsigned u, unsigned v, unsigned w) const {
    std::array<unsigned, 3> at{};
    at[u_] = u, at[v_] = v, at[w_] = w;
    return voxel_grid::morton(at[0], at[1], at[2]);
  }
  // The places of a block that are voxels.
  std::uint64_t present() const { return resolution_ < 4 ? 0xff : ~std::uint64_t{0}; }

  std::int64_t resolution_;
  unsigned edge_;  // in blocks
  std::size_t u_, v_, w_;
  std::array<std::uint64_t, 64> bits_{};
  std::vector<block_of_changes> changes_;
  std::vector<std::uint8_t> is_crossed_;
};

// Hands each block of voxels to `take(number, bits)`, bits set where the mesh winds around a voxel's centre, seen along `axis`.
template <class Take>
void winding_blocks(const triangles_on_grid& triangles, unsigned resolution, unsigned axis, const progress_handler& progress, Take&& take) {
  winding_layer layer(resolution, axis);
  const unsigned layers = std::max(resolution / 4, 1U);
  std::vector<std::vector<std::uint32_t>> beginning(layers);  // triangles by the first layer that they meet
  for (std::uint32_t n = 0; n < triangles.size(); ++n)
    if (const row_range rows(triangles[n], layer.row_axis(), resolution); rows.first < rows.past)
      beginning[static_cast<std::size_t>(rows.first / 4)].push_back(n);
  std::vector<std::uint32_t> met;
  for (unsigned number = 0; number < layers; ++number) {
    met.insert(met.end(), beginning[number].begin(), beginning[number].end());
    std::vector<std::uint32_t>().swap(beginning[number]);
    std::size_t kept = 0;
    for (const std::uint32_t n : met) {
      const grid_triangle t = triangles[n];
      layer.count(t, number);
      if (row_range(t, layer.row_axis(), resolution).past > 4 * (std::int64_t{number} + 1)) met[kept++] = n;
    }
    met.resize(kept);
    layer.hand_over(number, take);
    if (progress) progress(static_cast<double>(number + 1) / layers);
  }
}

}  // namespace

voxel_grid voxelise_surface(const mesh& m, unsigned resolution, double fit, const progress_handler& progress) {
  return surface(m, placement(m, resolution, fit), resolution, steps_counted(progress, m.triangles.size(), 0, 1));
}

voxel_grid voxelise_solid(const mesh& m, unsigned resolution, const std::string& place, double fit, const progress_handler& progress) {
  const auto refuse = [&](const edge_faults& edges, const char* what, const char* expected) {
    if (edges.count == 0) return;
    const auto text = [](const glm::dvec3& v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); };
    throw input_error(place, fmt::format("{} {}, the first from {} to {}", edges.count, what, text(edges.first[0]), text(edges.first[1])),
                      expected);
  };
  refuse(find_open_edges(m), "open edges", "a closed mesh to fill, or surface voxels");
  refuse(find_turned_edges(m), "edges whose faces run the same way", "a mesh with the same side of each face outside, or surface voxels");
  const placement where(m, resolution, fit);
  const triangles_on_grid triangles(m, where);
  const voxel_grid touched = surface(m, where, resolution, steps_counted(progress, m.triangles.size(), 0, 0.25));
  voxel_grid filled = touched;
  const auto along = [&](unsigned axis, double from, const auto& take) {
    const auto part = [&](double share) { progress(from + 0.25 * share); };
    winding_blocks(triangles, resolution, axis, progress ? progress_handler(part) : progress_handler(), take);
  };
  along(2, 0.25, [&](std::uint32_t number, std::uint64_t inside) { filled.fill_block(number, inside); });
  bool agree = true;
  for (const unsigned axis : {0U, 1U})
    along(axis, 0.5 + 0.25 * axis,
          [&](std::uint32_t number, std::uint64_t inside) { agree &= (inside | touched.blocks()[number]) == filled.blocks()[number]; });
  if (!agree) throw input_error(place, "voxels that are inside as seen along one axis alone", "a closed mesh");
  return filled;
}

}  // namespace rtusim
