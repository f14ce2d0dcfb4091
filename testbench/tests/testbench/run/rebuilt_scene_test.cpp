#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "modules/bih_core/bih_walk.h"
#include "modules/config/files.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "scenes/meshes/bezier_patches.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"
#include "testbench/tests/random_bih.h"
#include "testbench/tests/scratch.h"

/// Scenes that come from mesh files, through the whole way of the program, against those of the vectors.
namespace rtusim {
namespace {

const std::string teapot = RTUSIM_SOURCE_DIR "/scenes/data/teapot.bpt";
constexpr unsigned address_bits = 16;

/// The teapot at 3 x 3 and a cube beside it, as a file.
std::filesystem::path write_cubepot(const test::scratch_folder& folder) {
  const mesh m = tessellate(parse_bpt(config::read_file(teapot), teapot), 3);
  std::string obj;
  for (const glm::dvec3& v : m.vertices) obj += fmt::format("v {:.17g} {:.17g} {:.17g}\n", v.x, v.y, v.z);
  for (const auto& t : m.triangles) obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  const auto first = m.vertices.size() + 1;
  for (unsigned corner = 0; corner < 8; ++corner)
    obj += fmt::format("v {} {} {}\n", (corner & 1) != 0 ? 3.2 : 2.2, (corner & 2) != 0 ? 3.2 : 2.2, (corner & 4) != 0 ? 1.8 : 0.8);
  const unsigned faces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    obj += fmt::format("f {} {} {}\n", first + f[0], first + f[1], first + f[2]);
    obj += fmt::format("f {} {} {}\n", first + f[0], first + f[2], first + f[3]);
  }
  return folder.file("cubepot.obj", obj);
}

struct frame_figures {
  std::size_t rays = 0;
  std::uint64_t clocks = 0, triangles = 0, hits = 0;

  double fill() const { return static_cast<double>(triangles) / static_cast<double>(clocks); }
};

/// The frame of the vectors: its camera is mirrored in x against ours, which gives the same rays.
frame_figures trace(const triangle_model& model) {
  camera::params eye;
  eye.which = camera::params::kind::look_at;
  eye.position = {-0.55 * 1.96, 0.55 * 1.96, -1.15 * 1.96};
  eye.vertical_fov_degrees = 2 * std::atan(0.42) * 180 / camera::params::pi;
  const auto jobs = triangle_jobs(eye, {64, 48}, model.grid, direction_norm::one, true);
  const ray_setup setup({}, model.hierarchy.corner);
  const triangle_intersector intersect({}, test::triangles_as_built);
  bih_core_params p = test::bih_as_built();
  p.address_bits = address_bits;
  bih_walk walk(p, model.hierarchy);
  frame_figures sums;
  for (const job_packet& packet : jobs) {
    ray_setup_stats stats;
    triangle_job job;
    setup(packet, stats, job);
    bool hit = false;
    const bih_outcome o = walk(job.ray, [&](std::uint32_t triangle, std::uint64_t) {
      hit |= intersect(job.ray.position, job.ray.direction, model.hierarchy.triangles[triangle]).hit;
    });
    ++sums.rays;
    sums.clocks += o.cycles();
    sums.triangles += o.triangles;
    sums.hits += hit;
  }
  return sums;
}

}  // namespace

TEST_CASE("rebuilt scenes: teapot and cube from a file take the clocks of the vectors", "[scenes]") {
  const test::scratch_folder folder;
  const auto file = write_cubepot(folder);
  struct row {
    unsigned leaf;
    double clocks, fill;
  };
  const row rows[] = {{4, 142'053, 0.2732}, {8, 120'918, 0.3918}, {16, 120'349, 0.5766}};
  for (const row& r : rows) {
    const triangle_model model = load_triangles(file, {}, r.leaf, address_bits, 10);
    CHECK(model.hierarchy.triangles.size() == 564);
    const frame_figures f = trace(model);
    CAPTURE(r.leaf, f.rays, f.clocks, f.fill(), f.hits);
    CHECK(std::abs(static_cast<double>(f.rays) - 1'382) <= 2);
    CHECK(std::abs(static_cast<double>(f.hits) - 570) <= 2);
    CHECK(static_cast<double>(f.clocks) == Approx(r.clocks).epsilon(0.005));
    CHECK(f.fill() == Approx(r.fill).margin(0.005));
  }
}

TEST_CASE("rebuilt scenes: the teapot from its patches has as many triangles as in the thesis, and fills the pipeline as its does",
          "[scenes]") {
  const triangle_model fine = load_triangles(teapot, {}, 8, address_bits, 10);
  CHECK(fine.hierarchy.triangles.size() == 6'320);
  struct row {
    unsigned leaf;
    double fill;
  };
  const row rows[] = {{4, 0.281}, {8, 0.4057}, {16, 0.569}, {32, 0.727}};
  std::uint64_t fewest = ~std::uint64_t{0}, of_12 = 0;
  for (unsigned leaf = 4; leaf <= 32; leaf += 4) {
    const triangle_model model = load_triangles(teapot, {}, leaf, address_bits, 4);
    CHECK(model.hierarchy.triangles.size() == 992);
    const frame_figures f = trace(model);
    CAPTURE(leaf, f.rays, f.clocks, f.fill(), f.hits);
    const auto row = std::find_if(std::begin(rows), std::end(rows), [&](const auto& r) { return r.leaf == leaf; });
    if (row != std::end(rows)) CHECK(f.fill() == Approx(row->fill).margin(0.0006));
    fewest = std::min(fewest, f.clocks);
    if (leaf == 12) of_12 = f.clocks;
  }
  CHECK(of_12 == fewest);
}

}  // namespace rtusim
