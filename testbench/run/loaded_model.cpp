#include "testbench/run/loaded_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/rays/ray_list.h"
#include "scenes/voxels/octree_model.h"
#include "testbench/kinds/driver.h"

namespace rtusim {
namespace {

/// Which cube of an octree a ray hits, as the core's way down tells: its result's t is too coarse for that.
class cube_finder {
 public:
  cube_finder(const design& d, const std::vector<std::uint32_t>& octree)
      : memory_(view_of(octree, d.memory_)), walk_(d.svo_core_params_with_format()), converter_(d.fixed_point, d.float_to_fixed) {}

  svo_cube operator()(const job_packet& packet) const {
    numeric::float_to_fixed_stats ignored;
    traversal_job job;
    convert(packet, converter_, ignored, job);
    svo_cube cube;
    walk_(job, memory_, cube);
    return cube;
  }

 private:
  word_view memory_;
  svo_walk walk_;
  numeric::float_to_fixed_converter converter_;
};

/// The finest voxel, one of `cells` an edge, of a cube that may hold several: then the one at, or next to, a point in world units.
std::array<std::uint32_t, 3> finest_voxel(const svo_cube& cube, unsigned cells, const std::array<float, 3>& point) {
  std::array<std::uint32_t, 3> voxel{};
  const double size = static_cast<double>(cells) / std::ldexp(1.0, static_cast<int>(cube.levels));  // in finest voxels
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double first = std::floor(size * cube.place[axis]);
    const double at = std::floor((static_cast<double>(point[axis]) + 1) / 2 * cells);
    voxel[axis] = static_cast<std::uint32_t>(std::clamp(at, first, first + std::max(size, 1.0) - 1));
  }
  return voxel;
}

}  // namespace

loaded_model::loaded_model(const run_setup& s) : limits_{s.unit.memory_.address_bits, s.unit.svo_core.stack_depth} {
  const scene::model_params& m = s.what.model;
  if (s.unit.has_triangles())
    triangles_ = load_triangles(m.model, s.unit.quantisation_, s.unit.bih_builder.leaf_triangles, s.unit.bih_core.address_bits, m.patch_quads);
  else
    octree_ = load_octree(m.model, m.resolution, m.patch_quads, limits_);
}

host_figures loaded_model::host() const {
  host_figures h;
  if (triangles_) h.triangles = {triangles_->losses, triangles_->edge_shift};
  return h;
}

void loaded_model::settle(run_setup& s) const {
  if (triangles_) s.unit.quantisation_.edge_shift = triangles_->edge_shift;
}

sent_jobs loaded_model::jobs(std::vector<job_packet> given) const {
  sent_jobs sent{std::move(given), host()};
  sent.host.duplicate_ids = duplicate_ids(sent.packets);
  return sent;
}

sent_jobs loaded_model::jobs(const run_setup& s, unsigned threads, bool pictured) const {
  const driver_params& driver = s.unit.driver;
  const raster& f = s.what.picture;
  sent_jobs sent{{}, host()};
  std::size_t rays = std::size_t{f.width} * f.height;
  if (!s.what.model.rays.empty()) {
    const ray_list list(s.what.model.rays);
    if (pictured && list.size() != rays)
      throw input_error(s.what.model.rays, fmt::format("{} rays for a frame of {} x {}", list.size(), f.width, f.height),
                        "frame.width times frame.height of them, or no --image");
    rays = list.size();
    sent.packets = triangles_ ? triangle_jobs(list, triangles_->grid, driver.norm, driver.skip_misses, threads)
                              : list_jobs(list, slab_rules::of(driver, s.unit.fixed_point), 0, threads, &sent.host.replaced_components);
  } else if (triangles_) {
    sent.packets = triangle_jobs(s.what.view, f, triangles_->grid, driver.norm, driver.skip_misses, threads);
    if (sent.packets.empty())
      throw input_error("camera", "no ray meets the box of the model", "a camera that looks at it, or driver.skip_misses = false");
  } else {
    sent.packets = camera_jobs(s.what.view, f, slab_rules::of(driver, s.unit.fixed_point), 0, threads, &sent.host.replaced_components);
  }
  sent.host.unsent_rays = rays - sent.packets.size();
  return sent;
}

frame::places loaded_model::places(const run_setup& s, const std::vector<job_packet>& jobs, const frame& picture) const {
  frame::places where;
  const std::vector<frame::pixel>& pixels = picture.pixels();
  where.points.resize(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].hit) continue;
    const job_packet& job = jobs[pixels[i].sequence];
    const double distance = static_cast<double>(pixels[i].t_hit);
    const per_axis<float> point = triangles_ ? point_on_ray(job, triangles_->grid, distance) : point_on_ray(job, distance);
    if (std::isfinite(point[0] + point[1] + point[2])) where.points[i] = point;
  }
  if (triangles_) return where;
  where.cells = voxels_an_edge();
  where.voxels.resize(pixels.size());
  const cube_finder cubes(s.unit, octree_.words);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels[i].hit) where.voxels[i] = finest_voxel(cubes(jobs[pixels[i].sequence]), where.cells, where.points[i]);
  return where;
}

}  // namespace rtusim
