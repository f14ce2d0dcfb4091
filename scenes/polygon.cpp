#include "scenes/polygon.h"

#include <cmath>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

using plane_point = glm::dvec2;

// Twice the area of a triangle, above 0 where it turns counterclockwise.
double turn(const plane_point& a, const plane_point& b, const plane_point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The corners in a plane of two axes, such that the polygon as a whole turns counterclockwise.
std::vector<plane_point> projected(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners) {
  // Newell's normal, from the first corner on for the sake of precision.
  glm::dvec3 normal(0.0);
  const glm::dvec3& origin = vertices[corners[0]];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal += glm::cross(vertices[corners[i]] - origin, vertices[corners[i + 1]] - origin);
  const glm::dvec3 size(std::abs(normal.x), std::abs(normal.y), std::abs(normal.z));
  const int along = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int first = (along + 1) % 3, second = (along + 2) % 3;
  if (normal[along] < 0) std::swap(first, second);
  std::vector<plane_point> points;
  points.reserve(corners.size());
  for (const std::uint32_t c : corners) points.emplace_back((vertices[c] - origin)[first], (vertices[c] - origin)[second]);
  return points;
}

bool is_convex(const std::vector<plane_point>& points) {
  // Edges change between going right and going left twice in one turn; a star polygon's do more often.
  const std::size_t n = points.size();
  unsigned changes = 0;
  double last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const plane_point &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (turn(a, b, c) < 0) return false;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (last != 0 && (last < 0) != (step < 0)) ++changes;
    last = step;
  }
  return changes <= 2;
}

// Whether no other corner lies in the triangle of corner b and its neighbours a and c, borders included. `left`: the corners that
// have not been cut off.
bool is_ear(const std::vector<plane_point>& points, const std::vector<std::size_t>& left, std::size_t a, std::size_t b, std::size_t c) {
  for (const std::size_t other : left) {
    if (other == a || other == b || other == c) continue;
    const plane_point& p = points[other];
    if (p == points[a] || p == points[b] || p == points[c]) continue;
    if (turn(points[a], points[b], p) >= 0 && turn(points[b], points[c], p) >= 0 && turn(points[c], points[a], p) >= 0) return false;
  }
  return true;
}

}  // namespace

bool is_convex(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners) {
  return is_convex(projected(vertices, corners));
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  const std::vector<plane_point> points = projected(vertices, corners);
  if (corners.size() == 3 || is_convex(points)) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
    return triangles;
  }
  RTU_CHECK(corners.size(), <=, most_concave_corners);
  std::vector<std::size_t> left(corners.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::size_t at = 0, failures = 0;
  while (left.size() >= 3) {
    const std::size_t n = left.size();
    at %= n;
    const std::size_t a = left[(at + n - 1) % n], b = left[at], c = left[(at + 1) % n];
    const double turns = turn(points[a], points[b], points[c]);
    // Without an ear the polygon crosses itself: cut anywhere, so that this ends.
    if (turns == 0 || failures == n || (turns > 0 && is_ear(points, left, a, b, c))) {
      if (turns != 0) triangles.push_back({corners[a], corners[b], corners[c]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      failures = 0;
    } else {
      ++failures;
      ++at;
    }
  }
  return triangles;
}

}  // namespace rtusim
