#include "testbench/kinds/triangle_model.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "modules/config/error.h"
#include "scenes/meshes/mesh.h"
#include "scenes/triangles/bih_builder.h"
#include "scenes/triangles/quantised_triangles.h"
#include "scenes/voxels/octree_model.h"
#include "scenes/voxels/voxeliser.h"

namespace rtusim {
namespace {

double value_of(std::uint32_t float_bits) {
  float value;
  std::memcpy(&value, &float_bits, sizeof value);
  return static_cast<double>(value);
}

glm::dvec3 vec(const grid_point& p) { return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])}; }

}  // namespace

void triangle_figures::describe(config::report& r) const {
  r.group("triangles", [this](config::report& g) {
    g.number("dropped", losses.dropped, "triangles", "without area on the grid");
    g.number("clamped", losses.clamped, "triangles", "with an edge too long for quantisation.edge_shift, which was cut");
    g.number("edge_shift", edge_shift, "bits", "quantisation.edge_shift, as given or as auto chose it");
  });
}

void triangle_figures::warn(std::vector<std::string>& all) const {
  if (losses.dropped + losses.clamped != 0)
    all.push_back(fmt::format("of the triangles {} lost their area on the grid, {} have edges beyond edge_shift and were clamped",
                              losses.dropped, losses.clamped));
}

triangle_model load_triangles(const std::filesystem::path& file, const quantisation& q, unsigned leaf_triangles, unsigned address_bits,
                              unsigned patch_quads) {
  const std::string place = file.string();
  if (holds_voxels(file)) throw input_error(place, "voxels, which triangle cores can't trace", "a mesh");
  const mesh m = read_mesh(file, patch_quads);
  quantised_triangles on_grid = quantise(m, q, place);

  triangle_model model;
  std::vector<triangle_box> boxes;
  boxes.reserve(on_grid.corners.size());
  model.normals.reserve(on_grid.corners.size());
  for (const auto& corners : on_grid.corners) {
    triangle_box& box = boxes.emplace_back(triangle_box{corners[0], corners[0]});
    for (const grid_point& p : corners)
      for (unsigned i = 0; i < 3; ++i) {
        box.lower[i] = std::min(box.lower[i], p[i]);
        box.upper[i] = std::max(box.upper[i], p[i]);
      }
    const glm::dvec3 normal = glm::normalize(glm::cross(vec(corners[1]) - vec(corners[0]), vec(corners[2]) - vec(corners[0])));
    model.normals.push_back({static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)});
  }
  model.faces.reserve(on_grid.source.size());
  for (const std::uint32_t source : on_grid.source) model.faces.push_back(m.face_of(source));
  model.hierarchy = build_bih(boxes, leaf_triangles, address_bits, place);
  model.hierarchy.triangles = std::move(on_grid.triangles);
  model.hierarchy.corner = on_grid.box;
  model.losses = {on_grid.dropped, on_grid.clamped};
  model.edge_shift = on_grid.edge_shift;

  const bounding_box box = bounds(m);
  const double grid_units = on_grid.grid.units / on_grid.grid.side;  // a unit of the mesh
  model.grid.n = q.n;
  model.grid.scale = box.half_extent() / default_fit * grid_units;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    model.grid.centre[axis] = (box.centre()[i] - on_grid.grid.origin[i]) * grid_units;
    model.grid.corner[axis] = static_cast<double>(on_grid.box[axis]);
  }
  return model;
}

triangle_surfaces::triangle_surfaces(const triangle_model& model, const quantisation& q, std::int64_t distance_unit)
    : model_(model),
      setup_(q, model.hierarchy.corner),
      one_(std::ldexp(1.0, static_cast<int>(q.m) - 1)),
      origin_unit_(std::ldexp(1.0, static_cast<int>(q.n))),
      distance_unit_(static_cast<double>(distance_unit)) {}

frame::surface triangle_surfaces::at(const job_packet& job, const mesh_result& r) const {
  frame::surface s;
  if (!r.hit) return s;
  ray_setup_stats ignored;
  triangle_job ray;
  setup_(job, ignored, ray);
  glm::dvec3 origin, entry, direction;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    origin[i] = value_of(job.t0[axis]) * origin_unit_;
    entry[i] = static_cast<double>(ray.ray.position[axis]);
    direction[i] = static_cast<double>(ray.ray.direction[axis]) / one_;
  }
  const glm::dvec3 hit = entry + direction * (static_cast<double>(r.t_hit) * distance_unit_);
  s.distance = static_cast<float>(glm::length(hit - origin) / model_.grid.scale);
  const auto& n = model_.normals[r.triangle];
  const bool away = n[0] * direction.x + n[1] * direction.y + n[2] * direction.z > 0;
  for (std::size_t i = 0; i < 3; ++i) s.normal[i] = away ? -n[i] : n[i];
  s.triangle = model_.faces[r.triangle];
  return s;
}

}  // namespace rtusim
