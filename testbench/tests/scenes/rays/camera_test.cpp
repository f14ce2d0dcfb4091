#include "scenes/rays/camera.h"

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <zlib.h>

#include "modules/config/error.h"
#include "testbench/kinds/driver.h"
#include "testbench/run/job_file.h"

using namespace rtusim;

namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/sys/";
constexpr double pi = camera::params::pi;
constexpr std::uint32_t axis_x = 1u << 28, axis_y = 2u << 28, axis_z = 4u << 28;

std::array<std::uint32_t, 8> words(const job_packet& j) {
  return {j.job_word, j.t0[0], j.t0[1], j.t0[2], j.t1[0], j.t1[1], j.t1[2], j.address};
}

/// Of the packets as a file has them: little-endian words.
std::uint32_t crc_of(const std::vector<job_packet>& jobs) {
  std::uint32_t crc = 0;
  for (const job_packet& job : jobs) {
    std::array<Bytef, 32> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<Bytef>(words(job)[i / 4] >> 8 * (i % 4));
    crc = static_cast<std::uint32_t>(crc32(crc, bytes.data(), static_cast<uInt>(bytes.size())));
  }
  return crc;
}

std::map<std::string, std::uint32_t> golden_crcs() {
  std::ifstream in(golden + "jobs_crc32.txt");
  std::map<std::string, std::uint32_t> crcs;
  std::string name, crc;
  while (in >> name >> crc) crcs[name] = static_cast<std::uint32_t>(std::stoul(crc, nullptr, 16));
  return crcs;
}

/// The number of packets that differ; the first one's words appear in the test's report.
std::size_t differing(const std::vector<job_packet>& found, const std::vector<job_packet>& expected) {
  REQUIRE(found.size() == expected.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (words(found[i]) != words(expected[i]) && count++ == 0) {
      INFO("packet " << i);
      CHECK(words(found[i]) == words(expected[i]));
    }
  return count;
}

/// The camera as its documentation states it, a ray at a time, with nothing taken out of the loop.
std::vector<job_packet> plain_camera_jobs(const camera::params& p, const raster& f, bool last_sign_only) {
  const double aspect = static_cast<double>(f.width) / f.height;
  const glm::dmat4 inverse_projection = glm::inverse(glm::perspectiveRH_NO(glm::radians(p.vertical_fov_degrees), aspect, p.near, p.far));
  const double x_angle = 0.5 * std::sin(p.rotation[0]), y_angle = -p.rotation[1];
  glm::dmat4 rotation_x(1.0), rotation_y(1.0), translation(1.0);
  rotation_x[1] = {0, std::cos(x_angle), std::sin(x_angle), 0};
  rotation_x[2] = {0, -std::sin(x_angle), std::cos(x_angle), 0};
  rotation_y[0] = {std::cos(y_angle), 0, -std::sin(y_angle), 0};
  rotation_y[2] = {std::sin(y_angle), 0, std::cos(y_angle), 0};
  translation[3] = {p.position[0], p.position[1], p.position[2], 1};
  const glm::dmat4 inverse_view = translation * glm::transpose(rotation_x * rotation_y);

  std::vector<job_packet> jobs;
  for (unsigned y = 0; y < f.height; ++y)
    for (unsigned x = 0; x < f.width; ++x) {
      const double clip_x = (x + 0.5) / f.width * 2 - 1, clip_y = ((f.height - y - 1) + 0.5) / f.height * 2 - 1;
      glm::dvec4 start = inverse_view * (inverse_projection * glm::dvec4(clip_x, clip_y, -1, 1));
      glm::dvec4 end = inverse_view * (inverse_projection * glm::dvec4(clip_x, clip_y, 1, 1));
      start /= start.w;
      end /= end.w;
      const glm::dvec4 d = end - start;
      jobs.push_back(traversal_parameters({start.x, start.y, start.z}, {d.x, d.y, d.z}, y * f.width + x, {last_sign_only}, 0));
    }
  return jobs;
}

std::uint32_t bits(float value) {
  std::uint32_t word;
  std::memcpy(&word, &value, sizeof word);
  return word;
}

}  // namespace

TEST_CASE("camera: the thesis' frames, by the checksums of the golden job files") {
  const auto crcs = golden_crcs();
  const std::array<raster, 4> sizes{{{64, 36}, {320, 180}, {640, 360}, {1280, 720}}};
  std::size_t compared = 0;
  for (const auto& size : sizes)
    for (const bool last_sign_only : {true, false}) {
      const std::string name =
          "cam_" + std::to_string(size.width) + 'x' + std::to_string(size.height) + (last_sign_only ? "_literal.bin" : "_fixed.bin");
      INFO(name);
      REQUIRE(crcs.count(name) == 1);
      CHECK(crc_of(camera_jobs({}, size, {last_sign_only}, 0)) == crcs.at(name));
      ++compared;
    }
  CHECK(compared == crcs.size());
}

TEST_CASE("camera: the thesis' frames, word by word") {
  CHECK(differing(camera_jobs({}, {64, 36}, {true}, 0), read_jobs(golden + "jobs_64x36_literal.bin.gz")) == 0);
  CHECK(differing(camera_jobs({}, {320, 180}, {true}, 0), read_jobs(golden + "jobs_320x180_literal.bin.gz")) == 0);
}

TEST_CASE("camera: the same bits as one ray at a time with GLM") {
  struct row {
    const char* what;
    camera::params p;
    raster f;
  };
  const std::array<row, 8> table{{
      {"thesis", {}, {37, 23}},
      {"no rotation: components of exactly 0 in the middle", {75, 0.001, 100, {0, 0, 3}, {0, 0, 0}}, {9, 9}},
      {"a quarter turn", {60, 0.1, 10, {3, 0, 0}, {0, pi / 2, 0}}, {17, 5}},
      {"from behind", {40, 1, 2, {0, 0, -2.5}, {0, pi, 0}}, {8, 8}},
      {"one pixel", {75, 0.001, 100, {-0.5, 0.35, -2.1}, {1, 2, 0}}, {1, 1}},
      {"a wide angle", {170, 0.01, 1000, {0.1, -0.2, 0.3}, {-2, 5, 0}}, {31, 2}},
      {"planes far apart", {75, 1e-6, 1e6, {1, 2, 3}, {0.3, 0.7, 0}}, {16, 9}},
      {"planes close together, far away", {0.001, 1, 1.000002, {1e6, -1e6, 1e6}, {0.3, 0.7, 0}}, {16, 9}},
  }};
  for (const row& r : table)
    for (const bool last_sign_only : {true, false}) {
      INFO(r.what);
      const auto jobs = camera_jobs(r.p, r.f, {last_sign_only}, 0);
      CHECK(differing(jobs, plain_camera_jobs(r.p, r.f, last_sign_only)) == 0);
      for (const job_packet& job : jobs)
        for (const std::uint32_t t : job.t0) REQUIRE((t & 0x7f800000u) != 0x7f800000u);  // neither NaN nor infinite
    }
}

TEST_CASE("camera: rows shared by threads, or asked for in pieces, are the same rows") {
  const raster size{45, 31};
  const auto whole = camera_jobs({}, size, {}, 7);
  for (const unsigned threads : {0u, 2u, 3u, 31u, 100u}) CHECK(differing(camera_jobs({}, size, {}, 7, threads), whole) == 0);

  std::vector<job_packet> pieces(whole.size());
  const camera eye({}, size);
  const auto take = [&](const ray_lanes& rays, unsigned count, std::uint32_t pixel) {
    for (unsigned i = 0; i < count; ++i)
      pieces[pixel + i] = traversal_parameters({rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                                               {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]}, pixel + i, {}, 7);
  };
  eye.rows(0, 10, take);
  eye.rows(10, 10, take);
  eye.rows(10, 31, take);
  CHECK(differing(pieces, whole) == 0);
  CHECK(whole.back().address == 7);
  CHECK(whole.back().pixel() == 45 * 31 - 1);
}

TEST_CASE("camera: traversal parameters of single rays") {
  using axes = per_axis<double>;
  using t_words = per_axis<std::uint32_t>;
  struct row {
    axes origin, direction;
    std::uint32_t a, a_last;
  };
  const std::array<row, 7> table{{
      {{0, 0, 0}, {1, 1, 1}, 0, 0},
      {{0, 0, 0}, {-1, 1, 1}, axis_x, axis_x},
      {{0, 0, 0}, {-1, -1, 1}, axis_x | axis_y, axis_y},
      {{0, 0, 0}, {-1, 1, -1}, axis_x | axis_z, axis_z},
      {{0, 0, 0}, {1, -1, -1}, axis_y | axis_z, axis_z},
      {{0, 0, 0}, {-1, -1, -1}, axis_x | axis_y | axis_z, axis_z},
      {{0, 0, 0}, {-7, -7, -7}, axis_x | axis_y | axis_z, axis_z},
  }};
  for (const row& r : table) {
    const job_packet right = traversal_parameters(r.origin, r.direction, 5, {}, 9);
    const job_packet built = traversal_parameters(r.origin, r.direction, 5, {true}, 9);
    CHECK(right.job_word == (5 | r.a));
    CHECK(built.job_word == (5 | r.a_last));
    CHECK(right.t0 == built.t0);
    CHECK(right.t1 == built.t1);
    CHECK(right.address == 9);
    const float t = static_cast<float>(std::sqrt(3.0));
    CHECK(right.t0 == t_words{bits(-t), bits(-t), bits(-t)});
    CHECK(right.t1 == t_words{bits(t), bits(t), bits(t)});
  }

  // Along +z from z = -2: 1 and 3 on that axis; the others, whose 0 of either sign becomes 0.0001, from -10000 to 10000.
  const job_packet axial = traversal_parameters({0, 0, -2}, {0.0, -0.0, 5}, 0, {}, 0);
  CHECK(axial.job_word == 0);
  CHECK(axial.t0 == t_words{bits(-10000), bits(-10000), bits(1)});
  CHECK(axial.t1 == t_words{bits(10000), bits(10000), bits(3)});

  // Mirroring: along -x from x = 3, at y = 0.5.
  const job_packet mirrored = traversal_parameters({3, 0.5, 0}, {-2, 0, 0}, 0, {}, 0);
  CHECK(mirrored.job_word == axis_x);
  CHECK(mirrored.t0 == t_words{bits(2), bits(-15000), bits(-10000)});
  CHECK(mirrored.t1 == t_words{bits(4), bits(5000), bits(10000)});
}

TEST_CASE("camera: traversal parameters of rays that are none") {
  CHECK(traversal_parameters({0, 0, 0}, {1, 1, 1}, 0xffffffffu, {}, 0).job_word == job_id_mask);
  const job_packet still = traversal_parameters({0, 0, 0}, {0, 0, 0}, 1, {}, 0);
  CHECK(still.job_word == 1);
  for (const std::uint32_t t : still.t0) CHECK((t & 0x7fffffffu) > 0x7f800000u);  // NaN
  const job_packet remote = traversal_parameters({1e300, 0, 0}, {1, 1, 1}, 1, {}, 0);
  CHECK(remote.t0[0] == bits(-std::numeric_limits<float>::infinity()));
}

TEST_CASE("camera: contradicting parameters are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [near, far] : {std::pair{1.0, 1.0}, {2.0, 1.0}, {1.0, std::nextafter(1.0, 2.0)}, {nan, 1.0}, {1.0, nan}}) {
    camera::params p;
    p.near = near;
    p.far = far;
    CHECK_THROWS_AS(camera(p, {8, 8}), input_error);
  }
  camera::params rolled;
  rolled.rotation[2] = 0.1;
  CHECK_THROWS_WITH(camera(rolled, {8, 8}), Catch::Contains("0 for z"));
}

TEST_CASE("camera: its parameters and the frame's, with the thesis' values and limits that keep every ray finite") {
  camera::params p;
  config::section s("camera");
  p.describe(s);
  const auto real = [&s](const std::string& key) {
    for (const auto& parameter : s.parameters())
      if (parameter.key == key) return std::get<config::real_slot>(parameter.slot);
    FAIL("no " << key);
    return config::real_slot{};
  };
  const auto fov = real("camera.vertical_fov_degrees");
  CHECK(*fov.at == 75);
  CHECK(fov.limits.least > 0);
  CHECK(fov.limits.most < 180);
  CHECK(real("camera.near").limits.least > 0);

  raster f;
  config::section fs("frame");
  f.describe(fs);
  REQUIRE(fs.parameters().size() == 2);
  const auto& width = std::get<config::unsigned_slot>(fs.parameters()[0].slot);
  const auto& height = std::get<config::unsigned_slot>(fs.parameters()[1].slot);
  CHECK(width.get(width.at) == 1280);
  CHECK(height.get(height.at) == 720);
  CHECK(width.limits.least == 1);
  CHECK(width.limits.most * height.limits.most == std::uint64_t{job_id_mask} + 1);
}

namespace {

struct ray {
  per_axis<double> origin, direction;
};

std::vector<ray> rays_of(const camera::params& p, const raster& f) {
  std::vector<ray> all;
  camera(p, f).rows(0, f.height, [&](const ray_lanes& lanes, unsigned count, std::uint32_t pixel) {
    REQUIRE(pixel == all.size());
    for (unsigned i = 0; i < count; ++i)
      all.push_back({{lanes.origin[0][i], lanes.origin[1][i], lanes.origin[2][i]},
                     {lanes.direction[0][i], lanes.direction[1][i], lanes.direction[2][i]}});
  });
  return all;
}

void check_near(const per_axis<double>& found, const per_axis<double>& expected) {
  for (std::size_t i = 0; i < 3; ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-12));
}

}  // namespace

TEST_CASE("camera: aimed from an eye to a target, right on the right and up on top") {
  camera::params p;
  p.which = camera::params::kind::look_at;
  p.position = {0, 0, 5};
  p.target = {0, 0, 1};
  p.vertical_fov_degrees = 90;
  const auto seen = rays_of(p, {3, 3});
  REQUIRE(seen.size() == 9);
  check_near(seen[4].direction, {0, 0, -1});
  check_near(seen[0].direction, {-2.0 / 3, 2.0 / 3, -1});  // top left
  check_near(seen[8].direction, {2.0 / 3, -2.0 / 3, -1});
  for (const ray& r : seen) check_near(r.origin, p.position);

  p.lens = camera::params::projection::orthographic;
  p.height = 6;
  const auto parallel = rays_of(p, {3, 3});
  check_near(parallel[0].origin, {-2, 2, 5});
  check_near(parallel[5].origin, {2, 0, 5});
  for (const ray& r : parallel) check_near(r.direction, {0, 0, -1});

  p.up = {0, -3, 0};  // upside down
  check_near(rays_of(p, {3, 3})[0].origin, {2, -2, 5});
}

TEST_CASE("camera: on an orbit, also straight above and below") {
  camera::params p;
  p.which = camera::params::kind::orbit;
  p.target = {1, 2, 3};
  p.distance = 2;
  p.azimuth_degrees = 90;
  p.elevation_degrees = 0;
  check_near(rays_of(p, {1, 1})[0].origin, {3, 2, 3});
  check_near(rays_of(p, {1, 1})[0].direction, {-1, 0, 0});
  p.azimuth_degrees = 0;
  for (const double elevation : {90.0, -90.0}) {
    p.elevation_degrees = elevation;
    const auto seen = rays_of(p, {3, 3});
    check_near(seen[4].origin, {1, 2 + 2 * elevation / 90, 3});
    check_near(seen[4].direction, {0, -elevation / 90, 0});
    // As the eye climbs to there, +x stays on the right.
    CHECK(seen[5].direction[0] > 0.1);
  }
}

TEST_CASE("camera: what contradicts itself is refused") {
  camera::params p;
  p.which = camera::params::kind::look_at;
  p.target = p.position;
  CHECK_THROWS_WITH(camera(p, {}), Catch::Contains("in the eye"));
  p.target = {0, 0, 0};
  p.position = {0, 3, 0};
  CHECK_THROWS_WITH(camera(p, {}), Catch::Contains("along the view"));
  p.position = {0, 0, 3};
  p.up = {0, 0, 0};
  CHECK_THROWS_AS(camera(p, {}), input_error);
}
