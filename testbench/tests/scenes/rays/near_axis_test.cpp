// Rays along an axis, or nearly: what the unit hits against an exact walk along columns of voxels.

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/job_manager/job_manager.h"
#include "modules/memory/memory.h"
#include "modules/rtu/design.h"
#include "modules/svo_core/svo_kind.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/meshes/mesh.h"
#include "scenes/rays/camera.h"
#include "scenes/voxels/binvox.h"
#include "scenes/voxels/svo_builder.h"
#include "scenes/voxels/voxeliser.h"
#include "testbench/kinds/driver.h"

namespace rtusim {
namespace {

const std::string source = RTUSIM_SOURCE_DIR;

/// The rays of a camera, each by itself.
struct plain_ray {
  per_axis<double> origin, direction;
};

std::vector<plain_ray> rays_of(const camera::params& view, const raster& size) {
  std::vector<plain_ray> rays(std::size_t{size.width} * size.height);
  camera(view, size).rows(0, size.height, [&](const ray_lanes& lanes, unsigned count, std::uint32_t pixel) {
    for (unsigned i = 0; i < count; ++i)
      rays[pixel + i] = {{lanes.origin[0][i], lanes.origin[1][i], lanes.origin[2][i]},
                         {lanes.direction[0][i], lanes.direction[1][i], lanes.direction[2][i]}};
  });
  return rays;
}

/// Steps through the grid in long double: 1 for a hit, 0 for a miss, -1 where the ray moved sideways by `slack` world units finds something
/// else.
int exact_hit(const voxel_grid& grid, const plain_ray& ray, long double slack) {
  const int n = static_cast<int>(grid.resolution());
  const auto meets = [&](long double shift_u, long double shift_v) {
    // A ray moved sideways by the shifts along the two axes across its own.
    int main_axis = 0;
    for (int i = 1; i < 3; ++i)
      if (std::fabs(ray.direction[static_cast<std::size_t>(i)]) > std::fabs(ray.direction[static_cast<std::size_t>(main_axis)]))
        main_axis = i;
    long double o[3], d[3];
    for (int i = 0; i < 3; ++i) {
      o[i] = static_cast<long double>(ray.origin[static_cast<std::size_t>(i)]);
      d[i] = static_cast<long double>(ray.direction[static_cast<std::size_t>(i)]);
    }
    o[(main_axis + 1) % 3] += shift_u;
    o[(main_axis + 2) % 3] += shift_v;
    long double enter = 0, leave = HUGE_VALL;
    for (int i = 0; i < 3; ++i) {
      if (d[i] == 0) {
        if (o[i] < -1 || o[i] > 1) return false;
        continue;
      }
      const long double a = (-1 - o[i]) / d[i], b = (1 - o[i]) / d[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter >= leave) return false;
    int v[3];
    long double next[3], step[3];
    for (int i = 0; i < 3; ++i) {
      const long double at = (o[i] + d[i] * enter + 1) * n / 2;
      v[i] = std::min(std::max(static_cast<int>(std::floor(at)), 0), n - 1);
      step[i] = d[i] == 0 ? HUGE_VALL : 2.0L / n / std::fabs(d[i]);
      next[i] = d[i] == 0 ? HUGE_VALL : (2.0L * (v[i] + (d[i] > 0 ? 1 : 0)) / n - 1 - o[i]) / d[i];
    }
    for (;;) {
      if (grid.at(static_cast<unsigned>(v[0]), static_cast<unsigned>(v[1]), static_cast<unsigned>(v[2]))) return true;
      const int axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
      v[axis] += d[axis] > 0 ? 1 : -1;
      if (v[axis] < 0 || v[axis] >= n) return false;
      next[axis] += step[axis];
    }
  };
  const bool hit = meets(0, 0);
  for (const long double u : {-slack, slack})
    for (const long double v : {-slack, slack})
      if (meets(u, v) != hit) return -1;
  return hit ? 1 : 0;
}

struct agreement {
  std::size_t sure = 0, unsure = 0, differ = 0, hits = 0, exact_hits = 0, overflows = 0;
};

agreement compare(const voxel_grid& grid, const svo_image& image, const camera::params& view, const raster& size, const design& d) {
  const std::vector<plain_ray> rays = rays_of(view, size);
  const auto jobs = camera_jobs(view, size, slab_rules::of({}, d.of<svo_kind>().format), 0, 2);
  const svo_walk walk(d.of<svo_kind>().core_with_format());
  const word_view memory = view_of(image.words, d.of<svo_kind>().memory_);
  const numeric::float_to_fixed_converter converter(d.of<svo_kind>().format, d.of<svo_kind>().conversion);
  numeric::float_to_fixed_stats stats;
  agreement a;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    traversal_job job;
    convert(jobs[i], converter, stats, job);
    const bool hit = walk(job, memory).hit;
    a.hits += hit;
    const int exact = exact_hit(grid, rays[i], 1.5e-3L);  // a component of 0.0001 over the way through the cube, and back to the eye
    if (exact < 0) {
      ++a.unsure;
      continue;
    }
    ++a.sure;
    a.exact_hits += static_cast<std::size_t>(exact);
    a.differ += hit != (exact == 1);
  }
  a.overflows = stats.overflows;
  return a;
}

camera::params orbit(double azimuth, double elevation) {
  camera::params p;
  p.which = camera::params::kind::orbit;
  p.lens = camera::params::projection::orthographic;
  p.height = 2.2;
  p.distance = 3;
  p.azimuth_degrees = azimuth;
  p.elevation_degrees = elevation;
  return p;
}

constexpr std::pair<double, double> orbits[] = {{0, 0},  {90, 0},  {180, 0}, {270, 0}, {360, 0},  {45, 0},
                                                {0, 90}, {90, 90}, {0, -90}, {45, 90}, {45, -90}, {-90, 0}};

}  // namespace

TEST_CASE("near axes: an orthographic orbit at right angles hits what an exact walk does", "[near_axis]") {
  const design d;
  for (const char* name : {"bunny.obj", "dragon_res4.ply"}) {
    const mesh shape = read_mesh(source + "/scenes/data/" + name);
    for (const unsigned resolution : {32u, 128u}) {
      const voxel_grid grid = voxelise_surface(shape, resolution);
      const svo_image image = build_svo(grid, name);
      for (const auto& [azimuth, elevation] : orbits) {
        const agreement a = compare(grid, image, orbit(azimuth, elevation), {160, 90}, d);
        CAPTURE(name, resolution, azimuth, elevation, a.sure, a.unsure, a.hits, a.exact_hits);
        CHECK(a.differ == 0);
        CHECK(a.overflows == 0);
        CHECK(a.sure > 10 * a.unsure);
        CHECK(a.exact_hits > 1'000);
      }
    }
  }
}

TEST_CASE("near axes: a symmetric model looks the same from all four sides", "[near_axis]") {
  const voxel_grid grid = read_binvox(source + "/testbench/tests/cases/binvox_posts.binvox").grid;
  const svo_image image = build_svo(grid, "posts");
  const design d;
  for (const double azimuth : {0.0, 90.0, 180.0, 270.0, 360.0, -90.0, 720.0}) {
    CAPTURE(azimuth);
    CHECK(compare(grid, image, orbit(azimuth, 0), {64, 64}, d).hits == 858);
    camera::params perspective = orbit(azimuth, 0);
    perspective.lens = camera::params::projection::perspective;
    perspective.vertical_fov_degrees = 50;
    const agreement a = compare(grid, image, perspective, {65, 65}, d);
    CHECK(a.differ == 0);
    CHECK(a.overflows == 0);
    // Twelve rays pass exactly through edges between voxels, where the core takes x before y before z: a quarter turn changes four of them.
    CHECK(a.hits == (std::fmod(azimuth, 180) == 0 ? 1'225 : 1'229));
  }
}

TEST_CASE("near axes: a component that is too small is taken as 0 is, with its sign, or as the least that fits", "[near_axis]") {
  slab_rules rules;
  rules.limit = 32'768;
  const auto value = [](std::uint32_t bits) {
    float f;
    std::memcpy(&f, &bits, sizeof f);
    return static_cast<double>(f);
  };
  for (const double tiny : {1e-5, 1e-9, 1e-16, 1e-30, 1e-300, 4.9e-324, 3.0e-5})
    for (const double sign : {1.0, -1.0}) {
      CAPTURE(tiny, sign);
      // From the middle: as 0.0001.
      const job_packet near = traversal_parameters({0, 0.5, -2}, {sign * tiny, 0.25, 1}, 0, rules, 0);
      CHECK(value(near.t0[0]) == Approx(-10'000));
      CHECK(value(near.t1[0]) == Approx(10'000));
      CHECK((near.job_word >> job_id_bits & 7) == (sign < 0 ? 1u : 0u));
      // From afar 0.0001 is too small, too.
      const job_packet far = traversal_parameters({6, 0.5, -2}, {sign * tiny, 0.25, 1}, 0, rules, 0);
      CHECK(std::max(std::fabs(value(far.t0[0])), std::fabs(value(far.t1[0]))) < 32'768);
      CHECK(std::max(std::fabs(value(far.t0[0])), std::fabs(value(far.t1[0]))) > 32'700);
      // As built only 0 itself is replaced.
      const job_packet built = traversal_parameters({0, 0.5, -2}, {sign * tiny, 0.25, 1}, 0, {}, 0);
      CHECK(value(built.t1[0]) > 32'767);
    }
  // What the format can divide by stays.
  const job_packet kept = traversal_parameters({0, 0.5, -2}, {5e-5, 0, 1}, 0, rules, 0);
  CHECK(value(kept.t1[0]) == Approx(20'000));
  // Where the least that fits would turn the ray noticeably, it is left, and overflows in the unit.
  rules.limit = 8;
  const job_packet coarse = traversal_parameters({0, 0.5, -2}, {1e-3, 0, 1}, 0, rules, 0);
  CHECK(value(coarse.t1[0]) == Approx(1'000));
  std::uint64_t replaced = 3;
  camera_jobs(orbit(180, 0), {8, 8}, slab_rules::of({}, {}), 0, 2, &replaced);
  CHECK(replaced == 3 + 2 * 64);
}

}  // namespace rtusim
