// Triangles on the borders of voxels, along each axis and in both directions, against tests in whole numbers.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "scenes/meshes/mesh.h"
#include "scenes/voxels/voxel_grid.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/tests/random.h"

namespace rtusim {
namespace {

constexpr int edge = 8;            // voxels
constexpr int steps = 8;           // a voxel
using point = std::array<int, 3>;  // in steps from the grid's lower corner
using corners = std::array<point, 3>;

/// The mesh with points in two far corners, so that it stands where it is.
mesh placed(const std::vector<corners>& triangles) {
  mesh m;
  const auto add = [&m](const point& p) {
    m.vertices.emplace_back(p[0] / (0.5 * edge * steps) - 1, p[1] / (0.5 * edge * steps) - 1, p[2] / (0.5 * edge * steps) - 1);
    return static_cast<std::uint32_t>(m.vertices.size() - 1);
  };
  for (const corners& t : triangles) {
    const std::uint32_t a = add(t[0]), b = add(t[1]), c = add(t[2]);
    m.triangles.push_back({a, b, c});
  }
  for (const int end : {0, edge * steps}) {
    const std::uint32_t a = add({end, end, end});
    m.triangles.push_back({a, a, a});
  }
  return m;
}

/// Numbers of the voxels filled but for the far corners.
std::vector<int> filled(const voxel_grid& grid) {
  std::vector<int> all;
  for (unsigned z = 0; z < edge; ++z)
    for (unsigned y = 0; y < edge; ++y)
      for (unsigned x = 0; x < edge; ++x)
        if (grid.at(x, y, z) && x + y + z != 0 && x + y + z != 3 * (edge - 1)) all.push_back(static_cast<int>(x + edge * (y + edge * z)));
  return all;
}

/// n / d, d > 0.
struct fraction {
  std::int64_t n, d;
  bool operator<(const fraction& o) const { return n * o.d < o.n * d; }
};

/// Whether the segment from a to b has a point in the closed box.
bool meets(const point& a, const point& b, const point& lower, const point& upper) {
  fraction enter{0, 1}, leave{1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const int way = b[k] - a[k];
    if (way == 0) {
      if (a[k] < lower[k] || a[k] > upper[k]) return false;
      continue;
    }
    const fraction in{way > 0 ? lower[k] - a[k] : a[k] - upper[k], std::abs(way)};
    const fraction out{way > 0 ? upper[k] - a[k] : a[k] - lower[k], std::abs(way)};
    if (enter < in) enter = in;
    if (out < leave) leave = out;
  }
  return !(leave < enter);
}

/// Whether a side of the box along axis w, at (u, v) of the other two, has a point in the triangle. Where the triangle is parallel to w its
/// own edges tell.
bool pierces(const corners& t, std::size_t w, int u, int v, int from, int to) {
  const std::size_t a = (w + 1) % 3, b = (w + 2) % 3;
  std::array<std::int64_t, 3> share{};
  for (std::size_t k = 0; k < 3; ++k) {
    const point &p = t[(k + 1) % 3], &q = t[(k + 2) % 3];
    share[k] = std::int64_t{p[a] - u} * (q[b] - v) - std::int64_t{p[b] - v} * (q[a] - u);
  }
  std::int64_t all = share[0] + share[1] + share[2];
  if (all == 0) return false;
  if (all < 0) {
    for (auto& s : share) s = -s;
    all = -all;
  }
  if (*std::min_element(share.begin(), share.end()) < 0) return false;
  const std::int64_t at = share[0] * t[0][w] + share[1] * t[1][w] + share[2] * t[2][w];
  return from * all <= at && at <= to * all;
}

/// Whether a triangle and a closed box have a common point: the corners of what they have in common lie on the triangle's edges or on the
/// box' sides.
bool touches(const corners& t, const point& lower, const point& upper) {
  for (std::size_t k = 0; k < 3; ++k)
    if (meets(t[k], t[(k + 1) % 3], lower, upper)) return true;
  for (std::size_t w = 0; w < 3; ++w)
    for (const int u : {lower[(w + 1) % 3], upper[(w + 1) % 3]})
      for (const int v : {lower[(w + 2) % 3], upper[(w + 2) % 3]})
        if (pierces(t, w, u, v, lower[w], upper[w])) return true;
  return false;
}

std::vector<int> expected(const corners& t) {
  std::vector<int> all;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        if (x + y + z != 0 && x + y + z != 3 * (edge - 1) &&
            touches(t, {x * steps, y * steps, z * steps}, {(x + 1) * steps, (y + 1) * steps, (z + 1) * steps}))
          all.push_back(x + edge * (y + edge * z));
  return all;
}

/// The same triangles with their axes changed, `n` from 0 to 47: six orders, and each axis either way.
corners turned(const corners& t, unsigned n) {
  constexpr std::array<std::array<std::size_t, 3>, 6> orders{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  corners result{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k) {
      const int value = t[c][orders[n / 8][k]];
      result[c][k] = (n >> k & 1) != 0 ? edge * steps - value : value;
    }
  return result;
}

}  // namespace

TEST_CASE("a triangle on a voxel's border fills the voxels on both sides", "[voxeliser]") {
  struct row {
    const char* what;
    corners t;
    std::size_t voxels;
  };
  const int m = edge / 2 * steps;  // a border
  const row rows[] = {
      {"within a voxel", {{{m + 1, m + 1, m + 1}, {m + 6, m + 1, m + 2}, {m + 1, m + 6, m + 3}}}, 1},
      {"within a face", {{{m, m + 2, m + 2}, {m, m + 6, m + 2}, {m, m + 2, m + 6}}}, 2},
      {"within a face of the grid", {{{0, m + 2, m + 2}, {0, m + 6, m + 2}, {0, m + 2, m + 6}}}, 1},
      {"half of a face, its edges on the voxel's", {{{m, m, m}, {m, m + 8, m}, {m, m, m + 8}}}, 2 * 8},
      {"a corner on a face", {{{m, m + 4, m + 4}, {m + 4, m + 2, m + 4}, {m + 4, m + 6, m + 5}}}, 2},
      {"an edge on a side", {{{m, m, m + 1}, {m, m, m + 6}, {m + 4, m + 3, m + 3}}}, 4},
      {"a corner on a corner", {{{m, m, m}, {m + 4, m + 2, m + 1}, {m + 2, m + 4, m + 1}}}, 8},
      {"a step before a corner", {{{m + 1, m + 1, m + 1}, {m + 4, m + 2, m + 1}, {m + 2, m + 4, m + 1}}}, 1},
      {"a step behind it", {{{m - 1, m - 1, m - 1}, {m + 4, m + 2, m + 1}, {m + 2, m + 4, m + 1}}}, 0},
  };
  for (const row& r : rows)
    for (unsigned n = 0; n < 48; ++n) {
      const corners t = turned(r.t, n);
      CAPTURE(r.what, n);
      if (r.voxels != 0) CHECK(expected(t).size() == r.voxels);
      for (const corners& way : {t, corners{t[0], t[2], t[1]}, corners{t[1], t[2], t[0]}})
        REQUIRE(filled(voxelise_surface(placed({way}), edge, 1.0)) == expected(t));
    }
}

TEST_CASE("triangles over points in whole and half voxels fill what they touch", "[voxeliser]") {
  test::rng random(23);
  for (unsigned n = 0; n < 600; ++n) {
    const int grain = n % 3 == 0 ? steps : n % 3 == 1 ? steps / 2 : 1;  // on borders, on borders and centres, anywhere
    corners t{};
    for (auto& p : t)
      for (auto& c : p) c = static_cast<int>(random() % static_cast<unsigned>(edge * steps / grain + 1)) * grain;
    CAPTURE(n, t);
    REQUIRE(filled(voxelise_surface(placed({t}), edge, 1.0)) == expected(t));
  }
}

TEST_CASE("an octahedron whose corners and edges meet the rows of centres is filled to its surface", "[voxeliser]") {
  for (const int middle : {edge / 2 * steps, edge / 2 * steps + steps / 2, edge / 2 * steps - steps / 2, edge / 2 * steps + 1})
    for (const int radius : {steps, 2 * steps, 2 * steps + steps / 2, 3 * steps, 3 * steps + 3})
      for (const bool inside_out : {false, true}) {
        std::vector<corners> faces;
        for (unsigned octant = 0; octant < 8; ++octant) {
          corners t;
          t.fill({middle, middle, middle});
          for (std::size_t k = 0; k < 3; ++k) t[k][k] += (octant >> k & 1) != 0 ? radius : -radius;
          const bool mirrored = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2 == 0;
          if (mirrored != inside_out) std::swap(t[1], t[2]);
          faces.push_back(t);
        }
        // Vertices at the same place are one.
        mesh m;
        std::vector<point> points;
        const mesh apart = placed(faces);
        for (std::size_t n = 0; n < apart.triangles.size(); ++n) {
          std::array<std::uint32_t, 3> t{};
          for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3& v = apart.vertices[apart.triangles[n][k]];
            const auto at = std::find(m.vertices.begin(), m.vertices.end(), v);
            t[k] = static_cast<std::uint32_t>(at - m.vertices.begin());
            if (at == m.vertices.end()) m.vertices.push_back(v);
          }
          m.triangles.push_back(t);
        }
        std::vector<int> wanted;
        for (int z = 0; z < edge; ++z)
          for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x) {
              // The voxel's nearest point, in steps along the axes.
              int nearest = 0;
              for (const int c : {x, y, z}) nearest += std::max({0, c * steps - middle, middle - (c + 1) * steps});
              if (nearest <= radius && x + y + z != 0 && x + y + z != 3 * (edge - 1)) wanted.push_back(x + edge * (y + edge * z));
            }
        CAPTURE(middle, radius, inside_out);
        CHECK(filled(voxelise_solid(m, edge, "octahedron", 1.0)) == wanted);
      }
}

}  // namespace rtusim
