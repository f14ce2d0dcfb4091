#include "testbench/kinds/svo_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "scenes/voxels/octree_model.h"
#include "testbench/kinds/checksum.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/svo_walker.h"

namespace rtusim {
namespace {

/// Which cube of an octree a ray hits, as the core's way down tells: its result's t is too coarse for that.
class cube_finder {
 public:
  cube_finder(const svo_kind& kind, const std::vector<std::uint32_t>& octree)
      : memory_(view_of(octree, kind.memory_)), walk_(kind.core_with_format()), converter_(kind.format, kind.conversion) {}

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

svo_model::svo_model(const design& d, const scene& what, const voxel_driver_params& driver)
    : driver_(driver),
      limits_{d.of<svo_kind>().memory_.address_bits, d.of<svo_kind>().core.stack_depth},
      octree_(load_octree(what.model.model, what.model.resolution, what.model.patch_quads, limits_)),
      contents_(octree_.words) {}

unsigned svo_model::voxels_an_edge() const { return 1u << rtusim::describe(octree_, "model", limits_).levels; }

std::vector<job_packet> svo_model::camera_jobs(const design& d, const scene& what, unsigned threads, host_figures& host) const {
  return rtusim::camera_jobs(what.view, what.picture, slab_rules::of(driver_, d.of<svo_kind>().format), 0, threads,
                             &host.replaced_components);
}

std::vector<job_packet> svo_model::list_jobs(const design& d, const ray_list& rays, unsigned threads, host_figures& host) const {
  return rtusim::list_jobs(rays, slab_rules::of(driver_, d.of<svo_kind>().format), 0, threads, &host.replaced_components);
}

std::uint64_t svo_model::walk_cycles(const design& d, const std::vector<job_packet>& jobs) const {
  std::vector<svo_walked> walked(jobs.size());
  svo_way::jobs_type ignored;
  svo_way::walk(d.of<svo_kind>(), octree_.words)(jobs.data(), jobs.size(), walked.data(), ignored);
  return std::accumulate(walked.begin(), walked.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const svo_walked& ray) { return sum + ray.cost; });
}

std::unique_ptr<ray_walker> svo_model::walker(const design& d) const {
  return std::make_unique<svo_walker>(d.of<svo_kind>(), octree_.words);
}

loaded_model::result_keeper svo_model::keeper(const design&, const std::vector<job_packet>&, frame& picture) const {
  return [&picture](const traversal_result& r, std::uint64_t latency_cycles) {
    picture.store(static_cast<const voxel_result&>(r), latency_cycles);
  };
}

frame::places svo_model::places(const design& d, const std::vector<job_packet>& jobs, const frame& picture) const {
  frame::places where;
  where.points = points_of(jobs, picture, [](const job_packet& job, double distance) { return point_on_ray(job, distance); });
  where.cells = voxels_an_edge();
  const std::vector<frame::pixel>& pixels = picture.pixels();
  where.voxels.resize(pixels.size());
  const cube_finder cubes(d.of<svo_kind>(), octree_.words);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (pixels[i].hit) where.voxels[i] = finest_voxel(cubes(jobs[pixels[i].sequence]), where.cells, where.points[i]);
  return where;
}

void svo_model::describe(nlohmann::ordered_json& inputs) const {
  inputs["model_words"] = octree_.words.size();
  inputs["model_crc32"] = checksum()(octree_.words).text();
}

std::string svo_model::size_text() const { return fmt::format("{} voxels an edge", voxels_an_edge()); }

void svo_model::add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& any) const {
  const auto& r = static_cast<const voxel_result&>(any);
  const int axis = r.normal_axis;
  fmt::format_to(std::back_inserter(to), "{},{},{},{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit),
                 r.hit ? r.t_hit : 0, r.hit ? axis : -1, r.cost, r.t_hit, axis);
}

}  // namespace rtusim
