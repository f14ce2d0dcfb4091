#include "testbench/run/run_setup.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <zlib.h>

#include "modules/config/error.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/rays/ray_list.h"
#include "testbench/kinds/driver.h"
#include "testbench/run/record_paths.h"

namespace rtusim {
namespace {

std::set<std::string> with_bench(std::set<std::string> names) {
  names.insert(surroundings::sections().begin(), surroundings::sections().end());
  return names;
}

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

std::uint32_t crc32_of(const void* data, std::size_t bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(crc32_z(before, static_cast<const Bytef*>(data), bytes));
}

/// A model is the likeliest file to be given in place of another.
void check_is_no_model(const std::filesystem::path& file, const char* expected) {
  if (is_model(file)) throw input_error(file.string(), "a model", std::string(expected) + "; --model FILE is for models");
}

}  // namespace

void run_setup::describe() {
  unit.describe(parameters);
  bench.describe(parameters);
  what.describe(parameters);
}

void run_setup::start_files_at(const std::filesystem::path& folder) {
  for (std::string* path : {&what.model.model, &what.model.rays}) *path = place_of(folder, *path).string();
}

run_setup::run_setup(const run_sources& from) {
  describe();
  check_is_no_model(from.scene, "a scene file (TOML)");
  check_is_no_model(from.architecture, "an architecture file (TOML)");
  if (!from.architecture.empty()) parameters.read_toml(from.architecture, with_bench(design::sections()));
  const auto core = unit.rtu.core;
  if (!from.scene.empty()) {
    parameters.read_toml(from.scene, with_bench(scene::sections()));
    start_files_at(from.scene.parent_path());  // and those of the command line here
  }
  // Voxels in place of the scene's mesh leave nothing to divide, a mesh in place of patches nothing to cut.
  if (holds_voxels(from.model)) parameters.forget("scene.resolution");
  if (!from.model.empty() && !has_patches(from.model)) parameters.forget("scene.patch_quads");
  for (const std::string& a : from.assignments) parameters.set(a);
  if (!from.model.empty()) what.model.model = from.model.string();
  if (unit.rtu.core != core && parameters.leaves_unread(from.architecture)) {
    const auto word = [](rtu_params::core_kind kind) { return rtu_params::core_words()[static_cast<std::size_t>(kind)]; };
    throw input_error(
        "--set", fmt::format("rtu.core = {} for {}, a design of {} cores", word(unit.rtu.core), from.architecture.string(), word(core)),
        fmt::format("--arch with one of {} cores, as those in testbench/architectures", word(unit.rtu.core)));
  }
  check();
}

run_setup::run_setup(const nlohmann::json& recorded_parameters, const std::string& place, const std::filesystem::path& folder) {
  describe();
  parameters.read_json(recorded_parameters, place);
  start_files_at(folder);
  check();
}

void run_setup::check() const {
  parameters.check_read();
  if (what.model.model.empty()) throw input_error("run", "no model", "a scene file, --model FILE or --set scene.model=FILE");
}

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

nlohmann::ordered_json inputs_of(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs) {
  nlohmann::ordered_json inputs{{"scene", ""}, {"architecture", ""}, {"model", s.what.model.model}};
  std::uint32_t crc = 0;
  if (model.triangles()) {
    const bih_memory& h = model.triangles()->hierarchy;
    for (const auto& w : h.words) crc = crc32_of(w.data(), w.size() * sizeof w[0], crc);
    inputs["model_triangles"] = h.triangles.size();
  } else {
    crc = crc32_of(model.octree().data(), model.octree().size() * sizeof model.octree()[0]);
    inputs["model_words"] = model.octree().size();
  }
  inputs["model_crc32"] = fmt::format("{:08x}", crc);
  inputs["jobs"] = "";
  inputs["jobs_crc32"] = fmt::format("{:08x}", crc32_of(jobs.data(), jobs.size() * sizeof(job_packet)));
  return inputs;
}

}  // namespace rtusim
