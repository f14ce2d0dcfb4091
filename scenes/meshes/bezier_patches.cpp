#include "scenes/meshes/bezier_patches.h"

#include <cmath>
#include <cstdint>

#include "modules/config/error.h"
#include "modules/config/quotation.h"
#include "modules/config/words.h"

namespace rtusim {
namespace {

// The next number of a text; `what` it is.
template <class Number>
Number take(word_reader& words, const char* what) {
  const std::string_view word = words.anywhere();
  if (word.empty()) throw input_error(words.here(), "the end of the file", what);
  const auto value = number_in<Number>(word);
  if (!value) throw input_error(words.here(), quotation(word), what);
  return *value;
}

// The point of weight `t` between a and b, `s` = 1 - t. Exact at both ends and where a and b are equal; the same when the ends are
// exchanged along with the weights.
glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double s, double t) {
  glm::dvec3 p;
  for (int k = 0; k < 3; ++k) p[k] = a[k] == b[k] ? a[k] : s * a[k] + t * b[k];
  return p;
}

// De Casteljau's algorithm for a cubic.
glm::dvec3 cubic(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d, double s, double t) {
  const glm::dvec3 ab = between(a, b, s, t), bc = between(b, c, s, t), cd = between(c, d, s, t);
  return between(between(ab, bc, s, t), between(bc, cd, s, t), s, t);
}

}  // namespace

std::vector<bezier_patch> parse_bpt(std::string_view text, const std::string& place) {
  word_reader words(without_mark(text), place);
  const auto count = take<std::uint32_t>(words, "the number of Bezier patches");
  std::vector<bezier_patch> patches;
  for (std::uint32_t n = 0; n < count; ++n) {
    for (int side = 0; side < 2; ++side) {
      const auto degree = take<std::uint32_t>(words, "the degrees of a patch, 3 3");
      if (degree != 3) throw input_error(words.here(), fmt::format("a patch of degree {}", degree), "bicubic patches, 3 3");
    }
    bezier_patch& patch = patches.emplace_back();
    for (glm::dvec3& point : patch)
      for (int k = 0; k < 3; ++k) {
        point[k] = take<double>(words, "a coordinate of a control point");
        if (!std::isfinite(point[k])) throw input_error(words.here(), fmt::format("the coordinate {}", point[k]), "a finite number");
      }
  }
  if (const std::string_view rest = words.anywhere(); !rest.empty())
    throw input_error(words.here(), quotation(rest), fmt::format("the end of the file after {} patches", count));
  return patches;
}

mesh tessellate(const std::vector<bezier_patch>& patches, unsigned quads) {
  RTU_CHECK(quads, >=, 1U);
  RTU_CHECK(quads, <=, 256U);
  const unsigned points = quads + 1;
  mesh m;
  m.vertices.reserve(patches.size() * points * points);
  m.triangles.reserve(patches.size() * quads * quads * 2);
  for (const bezier_patch& p : patches) {
    const auto first = static_cast<std::uint32_t>(m.vertices.size());
    for (unsigned i = 0; i < points; ++i)
      for (unsigned j = 0; j < points; ++j) {
        const double si = double(quads - i) / quads, ti = double(i) / quads;
        const double sj = double(quads - j) / quads, tj = double(j) / quads;
        std::array<glm::dvec3, 4> across;  // the control points of the curve along j
        for (std::size_t k = 0; k < 4; ++k) across[k] = cubic(p[k], p[4 + k], p[8 + k], p[12 + k], si, ti);
        const glm::dvec3 v = cubic(across[0], across[1], across[2], across[3], sj, tj);
        m.vertices.emplace_back(v.x, v.z, v.y);
      }
    for (unsigned i = 0; i < quads; ++i)
      for (unsigned j = 0; j < quads; ++j) {
        const std::uint32_t a = first + i * points + j, b = a + points, c = b + 1, d = a + 1;
        m.triangles.push_back({a, b, d});
        m.triangles.push_back({b, c, d});
      }
  }
  return m;
}

}  // namespace rtusim
