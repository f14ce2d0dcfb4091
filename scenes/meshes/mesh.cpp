#include "scenes/meshes/mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "modules/config/alternatives.h"
#include "modules/config/endings.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/quotation.h"
#include "scenes/meshes/bezier_patches.h"
#include "scenes/meshes/gltf.h"
#include "scenes/meshes/obj.h"
#include "scenes/meshes/ply.h"
#include "scenes/meshes/polygon.h"
#include "scenes/meshes/stl.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t most_triangles = 50'000'000;        // instances of a glTF's meshes multiply
constexpr double least_extent = 1e-60, most_extent = 1e60;  // squares, and scales to and from the root cube, stay in range

// Reads files in the folder of another one, or below it.
class folder_reader {
 public:
  explicit folder_reader(const std::filesystem::path& file) : place_(file.string()), folder_(file.parent_path()) {}

  std::string operator()(const std::string& name, std::uint64_t most_bytes) const {
    const auto refuse = [&](const char* found) {
      throw input_error(place_, fmt::format("the buffer {}, {}", quotation(name), found), "a file beside the glTF or below its folder");
    };
    const auto is_control = [](unsigned char c) { return c < ' '; };
    if (name.empty() || std::any_of(name.begin(), name.end(), is_control)) refuse("which is no file's name");
    std::error_code missing;
    const std::filesystem::path file = folder_ / name;
    if (std::filesystem::path(name).is_absolute()) refuse("which is an absolute path");
    const std::filesystem::path home = std::filesystem::canonical(folder_.empty() ? "." : folder_, missing);
    const std::filesystem::path real = missing ? std::filesystem::path() : std::filesystem::canonical(file, missing);
    if (missing) refuse("which is not there");
    const std::filesystem::path from_home = real.lexically_relative(home);
    if (from_home.empty() || *from_home.begin() == "..") refuse("which lies outside of its folder");
    if (!std::filesystem::is_regular_file(real, missing)) refuse("which is no plain file");
    return config::read_file(file, most_bytes);
  }

 private:
  std::string place_;
  std::filesystem::path folder_;
};

struct mesh_format {
  std::string_view ending;
  /// Of patches none: they are cut into triangles, not parsed as polygons.
  polygons (*parse)(const std::filesystem::path& file, std::string_view bytes, const std::string& place);
};

template <bool binary>
polygons gltf_polygons(const std::filesystem::path& file, std::string_view bytes, const std::string& place) {
  return parse_gltf(bytes, binary, place, most_triangles, folder_reader(file));
}

template <polygons (*parse)(std::string_view, const std::string&)>
polygons lone_file(const std::filesystem::path&, std::string_view bytes, const std::string& place) {
  return parse(bytes, place);
}

constexpr std::string_view patches_ending = ".bpt";
constexpr mesh_format formats[] = {{".ply", lone_file<parse_ply>},  {".obj", lone_file<parse_obj>}, {".stl", lone_file<parse_stl>},
                                   {".gltf", gltf_polygons<false>}, {".glb", gltf_polygons<true>},  {patches_ending, nullptr}};

/// Null for an ending of none of them.
const mesh_format* format_of(const std::string& ending) {
  const auto* const found = std::find_if(std::begin(formats), std::end(formats), [&](const mesh_format& f) { return f.ending == ending; });
  return found == std::end(formats) ? nullptr : found;
}

std::string all_endings() {
  std::vector<std::string_view> endings;
  for (const mesh_format& f : formats) endings.push_back(f.ending);
  return config::alternatives(endings);
}

mesh triangles_of(polygons&& p, const std::string& place) {
  std::uint64_t triangles = 0;
  for (const std::uint32_t size : p.sizes) triangles += size < 3 ? 0 : size - 2;
  if (triangles > most_triangles) throw input_error(place, "a mesh of more triangles", fmt::format("at most {}", most_triangles));
  mesh m;
  m.triangles.reserve(static_cast<std::size_t>(triangles));
  m.faces.reserve(static_cast<std::size_t>(triangles));
  std::vector<std::uint32_t> corners;
  auto next = p.corners.cbegin();
  for (std::uint32_t f = 0; f < p.sizes.size(); ++f) {
    corners.assign(next, next + p.sizes[f]);
    next += p.sizes[f];
    if (corners.size() > most_concave_corners && !is_convex(p.vertices, corners))
      throw input_error(place, fmt::format("face {} has {} corners and is not convex", f, corners.size()),
                        fmt::format("at most {}", most_concave_corners));
    for (const auto& t : triangulate(p.vertices, corners)) {
      m.triangles.push_back(t);
      m.faces.push_back(f);
    }
  }
  m.vertices = std::move(p.vertices);
  return m;
}

void check_finite(const std::vector<glm::dvec3>& vertices, const std::string& place) {
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(vertices[v][k]))
        throw input_error(place, fmt::format("vertex {} has the coordinate {}", v, vertices[v][k]), "finite coordinates");
}

// What vertices are compared by: their coordinates in binary32, none finer than the last bit of the largest or than 2^-40 of the mesh's,
// so that what is 0 but for rounding is 0.
class binary32_place {
 public:
  explicit binary32_place(const bounding_box& box) {
    const glm::dvec3 far = glm::max(glm::abs(box.lower), glm::abs(box.upper));
    constexpr double most_extents = 256;
    const double reach = std::max({far.x, far.y, far.z});
    if (reach > most_extents * box.half_extent()) origin_ = box.centre();
    finest_bit_ = std::ilogb(origin_ == glm::dvec3(0.0) ? reach : box.half_extent()) - 40;
  }
  glm::dvec3 operator()(const glm::dvec3& v) const {
    const glm::dvec3 at = v - origin_, size = glm::abs(at);
    const double largest = std::max({size.x, size.y, size.z});
    if (!(largest > 0)) return glm::dvec3(0.0);
    constexpr int fraction_bits = 23;
    const int last_bit = std::max(std::ilogb(largest) - fraction_bits, finest_bit_);
    glm::dvec3 rounded;
    for (int k = 0; k < 3; ++k) rounded[k] = std::ldexp(std::nearbyint(std::ldexp(at[k], -last_bit)), last_bit);
    return rounded;
  }

 private:
  glm::dvec3 origin_{0.0};
  int finest_bit_;
};

bool is_before(const glm::dvec3& a, const glm::dvec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// For each of several points the first that is equal.
std::vector<std::uint32_t> firsts(const std::vector<glm::dvec3>& points) {
  std::vector<std::uint32_t> sorted(points.size()), first(points.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(),
            [&](std::uint32_t a, std::uint32_t b) { return is_before(points[a], points[b]) || (points[a] == points[b] && a < b); });
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool again = i != 0 && points[sorted[i]] == points[sorted[i - 1]];
    first[sorted[i]] = again ? first[sorted[i - 1]] : sorted[i];
  }
  return first;
}

// Makes vertices that agree one, each in the place of the first.
void weld(mesh& m) {
  const std::vector<std::uint32_t> same = firsts(m.vertices);
  std::vector<glm::dvec3> rounded(m.vertices.size());
  std::transform(m.vertices.begin(), m.vertices.end(), rounded.begin(), binary32_place(bounds(m)));
  std::vector<std::uint32_t> kept = firsts(rounded);
  // Where binary32 can't tell the ends of an edge apart, vertices must be equal to be one.
  std::vector<bool> too_coarse(m.vertices.size());
  for (const auto& t : m.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (kept[a] == kept[b] && same[a] != same[b]) too_coarse[kept[a]] = true;
    }
  for (std::uint32_t v = 0; v < kept.size(); ++v)
    if (too_coarse[kept[v]]) kept[v] = same[v];

  std::vector<std::uint32_t> moved(m.vertices.size());
  std::uint32_t size = 0;
  for (std::uint32_t v = 0; v < m.vertices.size(); ++v) {
    if (kept[v] != v) continue;
    moved[v] = size;
    m.vertices[size++] = m.vertices[v];
  }
  m.vertices.resize(size);
  for (auto& t : m.triangles)
    for (std::uint32_t& v : t) v = moved[kept[v]];
}

bool has_area(const mesh& m, const std::array<std::uint32_t, 3>& t) {
  const glm::dvec3 &a = m.vertices[t[0]], &b = m.vertices[t[1]], &c = m.vertices[t[2]];
  return glm::cross(b - a, c - a) != glm::dvec3(0.0);
}

void set_flat_apart(mesh& m) {
  std::size_t kept = 0;
  for (std::size_t n = 0; n < m.triangles.size(); ++n) {
    if (!has_area(m, m.triangles[n])) {
      m.flat_triangles.push_back(m.triangles[n]);
      continue;
    }
    m.triangles[kept] = m.triangles[n];
    m.faces[kept++] = m.face_of(n);
  }
  m.triangles.resize(kept);
  m.faces.resize(kept);
}

// The edges whose triangles `is_fault` finds wrong; it is given how many there are, and how many more of them run one way than the other.
template <class Fault>
edge_faults find_edges(const mesh& m, Fault&& is_fault) {
  // An edge by its lesser and its greater vertex; `way` is +1 where a triangle runs so and -1 where it runs back.
  struct side {
    std::uint32_t lesser, greater;
    std::int32_t way;
    std::uint32_t triangle;
  };
  std::vector<side> sides;
  sides.reserve(3 * m.all_triangles());
  for (std::uint32_t n = 0; n < m.all_triangles(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = m.triangle(n)[k], b = m.triangle(n)[(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1, n});
    }
  const auto key = [](const side& s) { return std::tie(s.lesser, s.greater, s.triangle); };
  std::sort(sides.begin(), sides.end(), [&](const side& a, const side& b) { return key(a) < key(b); });
  edge_faults found;
  const side* first = nullptr;
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    std::int64_t balance = 0;
    for (next = i; next < sides.size() && sides[next].lesser == sides[i].lesser && sides[next].greater == sides[i].greater; ++next)
      balance += sides[next].way;
    if (!is_fault(next - i, balance)) continue;
    ++found.count;
    if (first == nullptr || sides[i].triangle < first->triangle) first = &sides[i];
  }
  if (first != nullptr) found.first = {m.vertices[first->lesser], m.vertices[first->greater]};
  return found;
}

}  // namespace

double bounding_box::half_extent() const {
  const glm::dvec3 edges = upper - lower;
  return 0.5 * std::max(edges.x, std::max(edges.y, edges.z));
}

bounding_box bounds(const mesh& m) {
  if (m.triangles.empty()) return {};
  const glm::dvec3& first = m.vertices[m.triangles[0][0]];
  bounding_box box{first, first};
  for (const auto& t : m.triangles)
    for (const std::uint32_t v : t) {
      box.lower = glm::min(box.lower, m.vertices[v]);
      box.upper = glm::max(box.upper, m.vertices[v]);
    }
  return box;
}

void turn_up(mesh& m, unsigned axis, bool negative) {
  RTU_CHECK(axis, <, 3U);
  const double sign = negative ? -1 : 1;
  for (glm::dvec3& v : m.vertices) {
    if (axis == 0) v = {-sign * v.y, sign * v.x, v.z};
    if (axis == 1) v = {v.x, sign * v.y, sign * v.z};
    if (axis == 2) v = {v.x, sign * v.z, -sign * v.y};
  }
}

edge_faults find_open_edges(const mesh& m) {
  return find_edges(m, [](std::size_t triangles, std::int64_t) { return triangles % 2 != 0; });
}

edge_faults find_turned_edges(const mesh& m) {
  return find_edges(m, [](std::size_t triangles, std::int64_t balance) { return triangles % 2 == 0 && balance != 0; });
}

bool is_mesh(const std::filesystem::path& file) { return format_of(config::unzipped_ending_of(file)) != nullptr; }

bool has_patches(const std::filesystem::path& file) { return config::unzipped_ending_of(file) == patches_ending; }

mesh read_mesh(const std::filesystem::path& file, unsigned patch_quads) {
  const std::string place = file.string();
  const std::string ending = config::unzipped_ending_of(file);
  const mesh_format* const format = format_of(ending);
  if (format == nullptr)
    throw input_error(place, fmt::format("a mesh ending in {}", quotation(ending)), all_endings() + ", or one of these and .gz");
  std::string bytes = config::read_file(file, most_file_bytes);
  if (bytes.empty()) throw input_error(place, "an empty file", "a mesh");
  mesh m;
  if (format->parse == nullptr) {
    m = tessellate(parse_bpt(bytes, place), patch_quads);
    m.faces.resize(m.triangles.size());
    std::iota(m.faces.begin(), m.faces.end(), 0U);
    check_finite(m.vertices, place);
  } else {
    polygons p = format->parse(file, bytes, place);
    std::string().swap(bytes);
    check_finite(p.vertices, place);
    m = triangles_of(std::move(p), place);
  }
  if (m.triangles.empty()) throw input_error(place, "no faces", "a mesh of triangles or polygons");
  const double extent = bounds(m).half_extent();
  if (extent == 0) throw input_error(place, "a mesh without extent", "vertices at different places");
  if (extent < least_extent || extent > most_extent)
    throw input_error(place, fmt::format("a half extent of {}", extent), fmt::format("{} to {}", least_extent, most_extent));
  weld(m);
  set_flat_apart(m);
  if (m.triangles.empty()) throw input_error(place, "no face has an area", "a mesh of triangles or polygons");
  return m;
}

}  // namespace rtusim
