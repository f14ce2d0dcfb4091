#include "scenes/mesh.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <exception>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/scene.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "scenes/bezier_patches.h"
#include "scenes/enclosure.h"
#include "scenes/gltf_filter.h"
#include "scenes/mesh_file_checks.h"
#include "scenes/polygon.h"
#include "scenes/quotation.h"

namespace rtusim {
namespace {

constexpr std::uint64_t most_file_bytes = std::uint64_t{1} << 30;
constexpr std::uint64_t most_triangles = 50'000'000;  // instances of a glTF's meshes multiply
constexpr std::uint64_t most_vertices = 3 * most_triangles;
constexpr double least_extent = 1e-60, most_extent = 1e60;  // squares, and scales to and from the root cube, stay in range

// The name without `.gz`, and its ending in lower case.
struct mesh_name {
  explicit mesh_name(std::filesystem::path file) : path(std::move(file)) {
    ending = lower_ending();
    if (ending != ".gz") return;
    path.replace_extension();
    ending = lower_ending();
  }
  std::filesystem::path path;
  std::string ending;

 private:
  std::string lower_ending() const {
    std::string e = path.extension().string();
    std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return e;
  }
};

// Lets the importer read the one file that we read and checked; of others only what a glTF keeps beside itself.
class checked_files : public Assimp::IOSystem {
 public:
  checked_files(std::string name, std::string bytes, bool others) : main_(std::move(name)), others_(others) {
    allowance_.admit(bytes.size());
    files_.emplace(main_, std::move(bytes));
  }
  bool Exists(const char* name) const override {
    std::error_code unreadable;
    return name == main_ || (others_ && std::filesystem::is_regular_file(name, unreadable));
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::string_view(mode).find('w') != std::string_view::npos || !Exists(name)) return nullptr;
    auto found = files_.find(name);
    if (found == files_.end()) {
      try {
        found = files_.emplace(name, config::read_file(name, most_file_bytes)).first;
        allowance_.admit(found->second.size());
      } catch (const input_error&) {
        failure_ = std::current_exception();
        return nullptr;
      }
    }
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(found->second.data()), found->second.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

  // Why another file could not be read.
  const std::exception_ptr& failure() const { return failure_; }

 private:
  std::string main_;
  bool others_;
  std::map<std::string, std::string> files_;
  import_allowance allowance_;
  std::exception_ptr failure_;
};

glm::dmat4 to_glm(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1, m.d1}, {m.a2, m.b2, m.c2, m.d2}, {m.a3, m.b3, m.c3, m.d3}, {m.a4, m.b4, m.c4, m.d4}};
}

// Appends one part of a scene where a node puts it.
void append(const aiMesh& part, const glm::dmat4& transform, mesh& m, const std::string& place) {
  if (m.triangles.size() + part.mNumFaces > most_triangles || m.vertices.size() + part.mNumVertices > most_vertices)
    throw input_error(place, "a mesh of more triangles", fmt::format("at most {}", most_triangles));
  const auto first = static_cast<std::uint32_t>(m.vertices.size());
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& p = part.mVertices[v];
    m.vertices.emplace_back(transform * glm::dvec4(p.x, p.y, p.z, 1.0));
  }
  std::vector<std::uint32_t> corners;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    corners.assign(face.mIndices, face.mIndices + face.mNumIndices);
    for (std::uint32_t& c : corners) {
      if (c >= part.mNumVertices)
        throw input_error(place, fmt::format("face {} has vertex {}", f, c), fmt::format("one of the {} vertices", part.mNumVertices));
      c += first;
    }
    if (corners.size() > most_concave_corners && !is_convex(m.vertices, corners))
      throw input_error(place, fmt::format("face {} has {} corners and is not convex", f, corners.size()),
                        fmt::format("at most {}", most_concave_corners));
    for (const auto& t : triangulate(m.vertices, corners)) m.triangles.push_back(t);
  }
}

mesh collect(const aiScene& scene, const std::string& place) {
  struct visit { const aiNode* node; glm::dmat4 transform; };
  mesh m;
  std::vector<visit> open{{scene.mRootNode, glm::dmat4(1.0)}};
  while (!open.empty()) {
    const visit at = open.back();
    open.pop_back();
    const glm::dmat4 transform = at.transform * to_glm(at.node->mTransformation);
    for (unsigned i = 0; i < at.node->mNumMeshes; ++i) append(*scene.mMeshes[at.node->mMeshes[i]], transform, m, place);
    for (unsigned i = at.node->mNumChildren; i-- > 0;) open.push_back({at.node->mChildren[i], transform});
  }
  return m;
}

mesh import_mesh(const mesh_name& name, std::string bytes, const std::string& place) {
  const bool others = name.ending == ".gltf";
  auto* const files = new checked_files(name.path.string(), std::move(bytes), others);
  Assimp::Importer importer;
  importer.SetIOHandler(files);  // which owns it
  const auto fail = [&](const std::string& reason) {
    if (files->failure()) std::rethrow_exception(files->failure());
    throw input_error(place, printable(reason, 200), "a sound " + name.ending.substr(1) + " mesh");
  };
  try {
    const aiScene* const scene = importer.ReadFile(name.path.string(), 0);
    if (scene == nullptr) fail(importer.GetErrorString());
    return collect(*scene, place);
  } catch (const input_error&) {
    throw;
  } catch (const std::exception& e) {
    fail(e.what());
  }
  return {};
}

// Makes equal vertices one, each in the place of the first.
void weld(mesh& m) {
  const auto before = [](const glm::dvec3& a, const glm::dvec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::vector<std::uint32_t> sorted(m.vertices.size()), kept(m.vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 &p = m.vertices[a], &q = m.vertices[b];
    return before(p, q) || (p == q && a < b);
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool again = i != 0 && m.vertices[sorted[i]] == m.vertices[sorted[i - 1]];
    kept[sorted[i]] = again ? kept[sorted[i - 1]] : sorted[i];
  }
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

open_edges find_open_edges(const mesh& m) {
  // An edge by its lesser and its greater vertex; `way` is +1 where a triangle runs so and -1 where it runs back.
  struct side {
    std::uint32_t lesser, greater;
    std::int32_t way;
    std::uint32_t triangle;
  };
  std::vector<side> sides;
  sides.reserve(3 * m.triangles.size());
  for (std::uint32_t n = 0; n < m.triangles.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = m.triangles[n][k], b = m.triangles[n][(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1, n});
    }
  const auto key = [](const side& s) { return std::tie(s.lesser, s.greater, s.triangle); };
  std::sort(sides.begin(), sides.end(), [&](const side& a, const side& b) { return key(a) < key(b); });
  open_edges found;
  const side* first = nullptr;
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    std::int64_t balance = 0;
    for (next = i; next < sides.size() && sides[next].lesser == sides[i].lesser && sides[next].greater == sides[i].greater; ++next)
      balance += sides[next].way;
    if (balance == 0) continue;
    ++found.count;
    if (first == nullptr || sides[i].triangle < first->triangle) first = &sides[i];
  }
  if (first != nullptr) found.first = {m.vertices[first->lesser], m.vertices[first->greater]};
  return found;
}

mesh read_mesh(const std::filesystem::path& file, unsigned patch_quads) {
  const std::string place = file.string();
  const mesh_name name(file);
  constexpr std::string_view endings[] = {".ply", ".obj", ".stl", ".gltf", ".glb", ".bpt"};
  if (std::find(std::begin(endings), std::end(endings), name.ending) == std::end(endings))
    throw input_error(place, fmt::format("a mesh ending in {}", quotation(name.ending)),
                      ".ply, .obj, .stl, .gltf, .glb or .bpt, or one of these and .gz");
  std::string bytes = config::read_file(file, most_file_bytes);
  if (bytes.empty()) throw input_error(place, "an empty file", "a mesh");
  if (name.ending == ".ply") check_ply(bytes, place);
  if (name.ending == ".obj") check_obj(bytes, place);
  if (name.ending == ".stl") check_stl(bytes, place);
  if (name.ending == ".gltf" || name.ending == ".glb") bytes = filter_gltf(bytes, name.ending == ".glb", place, most_vertices);
  mesh m;
  if (name.ending == ".bpt")
    m = tessellate(parse_bpt(bytes, place), patch_quads);
  else
    m = enclosed(place, [&] { return import_mesh(name, std::move(bytes), place); });

  for (std::size_t v = 0; v < m.vertices.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(m.vertices[v][k]))
        throw input_error(place, fmt::format("vertex {} has the coordinate {}", v, m.vertices[v][k]), "finite coordinates");
  if (m.triangles.empty()) throw input_error(place, "no faces", "a mesh of triangles or polygons");
  const double extent = bounds(m).half_extent();
  if (extent == 0) throw input_error(place, "a mesh without extent", "vertices at different places");
  if (extent < least_extent || extent > most_extent)
    throw input_error(place, fmt::format("a half extent of {}", extent), fmt::format("{} to {}", least_extent, most_extent));
  weld(m);
  m.triangles.erase(std::remove_if(m.triangles.begin(), m.triangles.end(), [&](const auto& t) { return !has_area(m, t); }),
                    m.triangles.end());
  if (m.triangles.empty()) throw input_error(place, "no face has an area", "a mesh of triangles or polygons");
  return m;
}

}  // namespace rtusim
