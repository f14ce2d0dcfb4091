#include "scenes/rays/ray_list.h"

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <zlib.h>

#include "modules/config/error.h"
#include "testbench/kinds/driver.h"
#include "testbench/tests/scratch.h"

using namespace rtusim;

namespace {

using ray = ray_list::ray;

/// The rays as they come out again.
std::vector<ray> rays_of(const ray_list& list) {
  std::vector<ray> rays(list.size());
  list.rows(0, list.height(), [&](const ray_lanes& lanes, unsigned count, std::uint32_t pixel) {
    for (unsigned i = 0; i < count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rays[pixel + i].origin[axis] = static_cast<float>(lanes.origin[axis][i]);
        rays[pixel + i].direction[axis] = static_cast<float>(lanes.direction[axis][i]);
      }
  });
  return rays;
}

std::vector<ray> camera_rays(const camera::params& p, const raster& f) {
  std::vector<ray> rays(std::size_t{f.width} * f.height);
  camera(p, f).rows(0, f.height, [&](const ray_lanes& lanes, unsigned count, std::uint32_t pixel) {
    for (unsigned i = 0; i < count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rays[pixel + i].origin[axis] = static_cast<float>(lanes.origin[axis][i]);
        rays[pixel + i].direction[axis] = static_cast<float>(lanes.direction[axis][i]);
      }
  });
  return rays;
}

/// Parallel rays whose components binary32 holds exactly.
camera::params exact_camera() {
  camera::params p;
  p.which = camera::params::kind::look_at;
  p.lens = camera::params::projection::orthographic;
  p.position = {0, 0, 2};
  p.height = 2;
  return p;
}

std::size_t differing(const std::vector<job_packet>& found, const std::vector<job_packet>& expected) {
  REQUIRE(found.size() == expected.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) count += std::memcmp(&found[i], &expected[i], sizeof(job_packet)) != 0;
  return count;
}

std::string zipped(const std::string& bytes, const std::string& file) {
  const gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(out);
  return file;
}

}  // namespace

TEST_CASE("ray list: a table's columns in any order, words that are no number, what is too small for binary32") {
  const test::scratch_folder folder;
  const std::string text = "name,dz,dy,dx,oz,oy,ox\r\na,6,5,4,3,2,1\nb,nan,inf,-inf,1e-60,-1e-60,0.1\n";
  for (const auto& file : {folder.file("rays.csv", text), std::filesystem::path(zipped(text, (folder / "rays.csv.gz").string()))}) {
    const auto rays = rays_of(ray_list(file));
    REQUIRE(rays.size() == 2);
    CHECK(rays[0].origin == std::array<float, 3>{1, 2, 3});
    CHECK(rays[0].direction == std::array<float, 3>{4, 5, 6});
    CHECK(rays[1].origin[0] == 0.1f);
    CHECK(rays[1].origin[1] == 0);
    CHECK(std::signbit(rays[1].origin[1]));
    CHECK_FALSE(std::signbit(rays[1].origin[2]));
    CHECK(rays[1].direction[0] == -HUGE_VALF);
    CHECK(rays[1].direction[1] == HUGE_VALF);
    CHECK(std::isnan(rays[1].direction[2]));
  }
}

TEST_CASE("ray list: a table as a spreadsheet or a script writes it") {
  const test::scratch_folder folder;
  const auto rays = rays_of(ray_list(folder.file(
      "rays.csv", "\xef\xbb\xbf\"ox\", \"oy\", oz , dx, dy, dz\r\n1, +2, -3, \"4\", +5e-1, +1e-60\r\n+inf, 1, 1, 1, 1, 1\r\n\r\n")));
  REQUIRE(rays.size() == 2);
  CHECK(rays[0].origin == std::array<float, 3>{1, 2, -3});
  CHECK(rays[0].direction == std::array<float, 3>{4, 0.5f, 0});
  CHECK(rays[1].origin[0] == HUGE_VALF);
  for (const char* bad : {"+-1", "+", "", "1 2", "1;"})
    CHECK_THROWS_WITH(ray_list(folder.file("bad.csv", "ox,oy,oz,dx,dy,dz\n1,1,1,1,1," + std::string(bad) + "\n")),
                      Catch::Contains("bad.csv:2: dz = \"" + std::string(bad) + "\"; expected a number within binary32, inf or nan"));
}

TEST_CASE("ray list: little-endian words") {
  const test::scratch_folder folder;
  const std::string bytes("\0\0\x80\x3f\0\0\0\xc0\0\0\0\0\0\0\xc0\x7f\0\0\x80\x7f\0\0\x80\xbf", 24);
  for (const auto& file :
       {folder.file("rays.bin", bytes + bytes), std::filesystem::path(zipped(bytes + bytes, (folder / "rays.bin.gz").string()))}) {
    const auto rays = rays_of(ray_list(file));
    REQUIRE(rays.size() == 2);
    CHECK(rays[1].origin == std::array<float, 3>{1, -2, 0});
    CHECK(std::isnan(rays[1].direction[0]));
    CHECK(rays[1].direction[1] == HUGE_VALF);
    CHECK(rays[1].direction[2] == -1);
  }
}

TEST_CASE("ray list: packets for voxel cores are those of one ray at a time, at every length of the list") {
  const auto rays = camera_rays({}, {37, 5});
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{8}, std::size_t{9}, rays.size()})
    for (const bool last_sign_only : {true, false}) {
      const ray_list list({rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(count)});
      std::vector<job_packet> expected;
      for (std::size_t i = 0; i < count; ++i) {
        const auto& [o, d] = rays[i];
        expected.push_back(
            traversal_parameters({o[0], o[1], o[2]}, {d[0], d[1], d[2]}, static_cast<std::uint32_t>(i), {last_sign_only}, 5));
      }
      for (const unsigned threads : {1u, 2u, 100u}) CHECK(differing(list_jobs(list, {last_sign_only}, 5, threads), expected) == 0);
    }
}

TEST_CASE("ray list: a camera's rays as a list are the camera's packets") {
  const raster size{64, 32};
  const camera::params p = exact_camera();
  const ray_list list(camera_rays(p, size));
  CHECK(differing(list_jobs(list, {}, 0), camera_jobs(p, size, {}, 0)) == 0);
  const grid_mapping grid{1000, {500, 400, 300}, {1000, 800, 600}, 10};
  for (const auto norm : {direction_norm::one, direction_norm::two})
    for (const bool skip_misses : {true, false}) {
      const auto expected = triangle_jobs(p, size, grid, norm, skip_misses);
      CHECK((expected.size() < list.size()) == skip_misses);
      CHECK(differing(triangle_jobs(list, grid, norm, skip_misses, 2), expected) == 0);
    }
}

TEST_CASE("driver: a point on a ray, from its packet") {
  const auto rays = camera_rays({}, {16, 9});
  const grid_mapping grid{1000, {500, 400, 300}, {1000, 800, 600}, 10};
  const ray_list list(rays);
  const auto voxel_jobs = list_jobs(list, {}, 0);
  const auto one = triangle_jobs(list, grid, direction_norm::one, false), two = triangle_jobs(list, grid, direction_norm::two, false);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    double length = 0;
    for (const float d : rays[i].direction) length += static_cast<double>(d) * static_cast<double>(d);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto expected =
          Approx(static_cast<double>(rays[i].origin[axis]) + 2.5 * static_cast<double>(rays[i].direction[axis]) / std::sqrt(length))
              .margin(2e-5);
      REQUIRE(static_cast<double>(point_on_ray(voxel_jobs[i], 2.5)[axis]) == expected);
      REQUIRE(static_cast<double>(point_on_ray(one[i], grid, 2.5)[axis]) == expected);
      REQUIRE(static_cast<double>(point_on_ray(two[i], grid, 2.5)[axis]) == expected);
    }
  }
}
