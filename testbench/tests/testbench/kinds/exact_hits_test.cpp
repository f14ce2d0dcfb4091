#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "modules/bih_core/bih_walk.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/rtu/design.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "scenes/meshes/mesh.h"
#include "scenes/scene.h"
#include "scenes/triangles/quantised_triangles.h"
#include "testbench/kinds/bih_host.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/triangle_model.h"

/// What the cores find without their errata against Moeller and Trumbore's test in binary64, of the same triangles on the grid and
/// the same rays, each ray against each triangle.
namespace rtusim {
namespace {

/// Triangles side by side, for the host's vector unit.
struct triangle_lanes {
  std::vector<double> corner[3], first[3], second[3];  // a corner and the edges from it

  explicit triangle_lanes(const std::vector<std::array<grid_point, 3>>& triangles) {
    for (const auto& t : triangles)
      for (unsigned i = 0; i < 3; ++i) {
        corner[i].push_back(static_cast<double>(t[0][i]));
        first[i].push_back(static_cast<double>(t[1][i] - t[0][i]));
        second[i].push_back(static_cast<double>(t[2][i] - t[0][i]));
      }
  }

  /// The distance in directions to the nearest hit, or infinity.
  double nearest(const per_axis<double>& o, const per_axis<double>& d) const {
    constexpr double none = std::numeric_limits<double>::infinity();
    double least = none;
    const std::size_t count = corner[0].size();
    for (std::size_t k = 0; k < count; ++k) {
      const double ax = first[0][k], ay = first[1][k], az = first[2][k];
      const double bx = second[0][k], by = second[1][k], bz = second[2][k];
      const double px = d[1] * bz - d[2] * by, py = d[2] * bx - d[0] * bz, pz = d[0] * by - d[1] * bx;
      const double det = ax * px + ay * py + az * pz;
      const double sx = o[0] - corner[0][k], sy = o[1] - corner[1][k], sz = o[2] - corner[2][k];
      const double u = (sx * px + sy * py + sz * pz) / det;
      const double qx = sy * az - sz * ay, qy = sz * ax - sx * az, qz = sx * ay - sy * ax;
      const double v = (d[0] * qx + d[1] * qy + d[2] * qz) / det;
      const double t = (bx * qx + by * qy + bz * qz) / det;
      const bool hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0);  // none of them where det is 0
      least = hit && t < least ? t : least;
    }
    return least;
  }
};

struct agreement {
  std::size_t rays = 0, agree = 0, hits = 0, exact_hits = 0;
  double greatest_error = 0;  // of t, in grid units, where both hit

  double share() const { return static_cast<double>(agree) / static_cast<double>(rays); }
};

/// Each `every`-th ray of a scene's frame of 640 x 480.
agreement compare(const std::string& name, std::size_t every) {
  const std::string folder = RTUSIM_SOURCE_DIR "/scenes/";
  scene s;
  config::schema parameters;
  s.describe(parameters);
  parameters.read_toml(folder + name + ".toml", scene::home);
  const std::string file = folder + s.model.model;

  const design d;
  const quantisation& q = d.of<bih_kind>().words;
  const triangle_model model =
      load_triangles(file, q, bih_builder_params{}.leaf_triangles, d.of<bih_kind>().core.address_bits, s.model.patch_quads);
  const triangle_lanes exact(quantise(read_mesh(file, s.model.patch_quads), q, file).corners);
  const auto jobs = triangle_jobs(s.view, {640, 480}, model.grid, triangle_driver_params{}.norm, true);
  const ray_setup setup(q, model.hierarchy.corner);
  const triangle_intersector intersect(q, {});
  bih_walk walk(d.of<bih_kind>().core_with_widths(), model.hierarchy);
  const double one = std::ldexp(1.0, static_cast<int>(q.m) - 1);
  agreement a;
  for (std::size_t i = 0; i < jobs.size(); i += every) {
    ray_setup_stats stats;
    triangle_job job;
    setup(jobs[i], stats, job);
    const quantised_ray& ray = job.ray;
    std::uint64_t nearest = ~std::uint64_t{0};
    walk(ray, [&](std::uint32_t triangle, std::uint64_t) {
      const triangle_outcome o = intersect.hit_only(ray.position, ray.direction, model.hierarchy.triangles[triangle]);
      if (o.hit) nearest = std::min(nearest, o.t);
    });
    per_axis<double> from, along;
    for (unsigned k = 0; k < 3; ++k) {
      from[k] = static_cast<double>(ray.position[k]);
      along[k] = static_cast<double>(ray.direction[k]) / one;
    }
    const double t = exact.nearest(from, along);
    const bool hit = nearest != ~std::uint64_t{0}, exact_hit = std::isfinite(t);
    ++a.rays;
    a.agree += hit == exact_hit;
    a.hits += hit;
    a.exact_hits += exact_hit;
    if (hit && exact_hit) a.greatest_error = std::max(a.greatest_error, std::fabs(t - static_cast<double>(nearest)));
  }
  return a;
}

}  // namespace

TEST_CASE("exact hits: without errata teapot and dragon are what an exact test sees", "[system]") {
  for (const auto& [name, every] : {std::pair{"teapot", 17}, {"dragon", 61}}) {
    const agreement a = compare(name, static_cast<std::size_t>(every));
    CAPTURE(name, a.rays, a.agree, a.hits, a.exact_hits, a.greatest_error);
    CHECK(a.share() > 0.999);
    CHECK(a.hits > 300);
  }
}

TEST_CASE("exact hits: all rays of teapot and dragon", "[.full]") {
  for (const char* name : {"teapot", "dragon"}) {
    const agreement a = compare(name, 1);
    WARN(name << ": " << a.rays << " rays, " << a.agree << " agree, " << a.hits << " hits, " << a.exact_hits
              << " exact; t differs by up to " << a.greatest_error << " grid units");
    CHECK(a.share() > 0.999);
  }
}

}  // namespace rtusim
