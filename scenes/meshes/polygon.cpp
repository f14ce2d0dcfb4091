#include "scenes/meshes/polygon.h"

#include <utility>

#include <glm/common.hpp>
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
  glm::dvec3 normal(0.0), reach(0.0);
  const glm::dvec3& origin = vertices[corners[0]];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const glm::dvec3 a = vertices[corners[i]] - origin, b = vertices[corners[i + 1]] - origin, n = glm::cross(a, b);
    normal += n;
    reach += glm::abs(n);
  }
  // A bow tie's parts may cancel out; then they tell the plane one by one.
  const glm::dvec3 size = normal == glm::dvec3(0.0) ? reach : glm::abs(normal);
  const int along = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int first = (along + 1) % 3, second = (along + 2) % 3;
  if (normal[along] < 0) std::swap(first, second);
  std::vector<plane_point> points;
  points.reserve(corners.size());
  for (const std::uint32_t c : corners) points.emplace_back((vertices[c] - origin)[first], (vertices[c] - origin)[second]);
  return points;
}

enum class shape : std::uint8_t { concave, convex, strictly_convex };

shape shape_of(const std::vector<plane_point>& points) {
  // Edges change between going right and going left twice in one turn; a star polygon's do more often.
  const std::size_t n = points.size();
  unsigned changes = 0;
  double last = 0;
  bool strictly = true;
  for (std::size_t i = 0; i < n; ++i) {
    const plane_point &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    const double turns = turn(a, b, c);
    if (turns < 0) return shape::concave;
    strictly &= turns > 0;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (last != 0 && (last < 0) != (step < 0)) ++changes;
    last = step;
  }
  if (changes > 2) return shape::concave;
  return strictly ? shape::strictly_convex : shape::convex;
}

// Cuts ears off a polygon: corners that turn counterclockwise and whose triangle, its border included, holds no other corner.
class ear_cutter {
 public:
  explicit ear_cutter(const std::vector<plane_point>& points)
      : points_(points), next_(points.size()), previous_(points.size()), ear_(points.size()) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::size_t i = 0; i < n; ++i) ear_[i] = is_ear(i);
  }

  // Takes a corner off; gives it between its neighbours.
  std::array<std::size_t, 3> cut() {
    const std::size_t b = choice(), a = previous_[b], c = next_[b];
    next_[a] = c;
    previous_[c] = a;
    // The ears among the others stay what they are, since what is left of the polygon lies within what there was.
    ear_[a] = is_ear(a);
    ear_[c] = is_ear(c);
    at_ = c;
    return {a, b, c};
  }

 private:
  double turn_at(std::size_t b) const { return turn(points_[previous_[b]], points_[b], points_[next_[b]]); }
  bool is_ear(std::size_t b) const {
    const std::size_t a = previous_[b], c = next_[b];
    const plane_point &p = points_[a], &q = points_[b], &r = points_[c];
    if (!(turn(p, q, r) > 0)) return false;
    for (std::size_t other = next_[c]; other != a; other = next_[other]) {
      const plane_point& o = points_[other];
      if (o == p || o == q || o == r) continue;
      if (turn(p, q, o) >= 0 && turn(q, r, o) >= 0 && turn(r, p, o) >= 0) return false;
    }
    return true;
  }
  // The next ear. Without one the polygon crosses or touches itself, or has no area: then a corner without area, or any, so that this ends.
  std::size_t choice() const {
    std::size_t straight = points_.size(), i = at_;
    do {
      if (ear_[i]) return i;
      if (straight == points_.size() && turn_at(i) == 0) straight = i;
      i = next_[i];
    } while (i != at_);
    return straight != points_.size() ? straight : at_;
  }

  const std::vector<plane_point>& points_;
  std::vector<std::size_t> next_, previous_;  // of the corners that are left
  std::vector<bool> ear_;
  std::size_t at_ = 0;
};

}  // namespace

bool is_convex(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners) {
  return shape_of(projected(vertices, corners)) != shape::concave;
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<glm::dvec3>& vertices, const std::vector<std::uint32_t>& corners) {
  if (corners.size() < 3) return {};
  if (corners.size() == 3) return {{corners[0], corners[1], corners[2]}};
  const std::vector<plane_point> points = projected(vertices, corners);
  const shape s = shape_of(points);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(corners.size() - 2);
  if (s == shape::strictly_convex || (s == shape::convex && corners.size() > most_concave_corners)) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) triangles.push_back({corners[0], corners[i], corners[i + 1]});
    return triangles;
  }
  RTU_CHECK(corners.size(), <=, most_concave_corners);
  ear_cutter cutter(points);
  while (triangles.size() + 2 < corners.size()) {
    const auto [a, b, c] = cutter.cut();
    triangles.push_back({corners[a], corners[b], corners[c]});
  }
  return triangles;
}

}  // namespace rtusim
