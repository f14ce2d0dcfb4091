#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "modules/formats/svo_image.h"
#include "modules/numeric/float_to_fixed.h"
#include "modules/svo_core/svo_walk.h"
#include "scenes/voxels/svo_builder.h"
#include "testbench/kinds/driver.h"

namespace rtusim {
namespace {

struct cell {
  int x = 0, y = 0, z = 0, size = 0;  // in finest voxels
};

/// Where the cube of each descriptor word lies.
std::vector<cell> cubes_of(const svo_image& image, int resolution) {
  std::vector<cell> cubes(image.words.size());
  std::vector<std::uint32_t> open{0};
  cubes[0] = {0, 0, 0, resolution};
  while (!open.empty()) {
    const std::uint32_t entry = open.back();
    open.pop_back();
    const std::uint32_t word = image.words[entry];
    for (unsigned slot = 0; slot < 8; ++slot) {
      if (!is_valid(word, slot) || is_leaf(word, slot)) continue;
      const auto child = static_cast<std::uint32_t>(child_group(image, entry) + child_nodes_before(word, slot));
      const int half = cubes[entry].size / 2;
      cubes[child] = {cubes[entry].x + static_cast<int>(slot & 1) * half, cubes[entry].y + static_cast<int>(slot >> 1 & 1) * half,
                      cubes[entry].z + static_cast<int>(slot >> 2 & 1) * half, half};
      open.push_back(child);
    }
  }
  return cubes;
}

struct reference_hit {
  bool hit = false;
  int axis = no_axis;
  int voxel[3] = {};
};

/// Steps a ray through the grid voxel by voxel (Amanatides and Woo 1987) in binary64: no octree, no fixed point.
reference_hit step_through(const voxel_grid& grid, const double (&origin)[3], const double (&direction)[3]) {
  const int n = static_cast<int>(grid.resolution());
  double enter = 0, leave = INFINITY;
  int axis = no_axis;
  for (int i = 0; i < 3; ++i) {
    double near = (-1 - origin[i]) / direction[i], far = (1 - origin[i]) / direction[i];
    if (near > far) std::swap(near, far);
    if (near > enter) enter = near, axis = i;
    leave = std::min(leave, far);
  }
  if (enter >= leave) return {};
  int v[3];
  double next[3], step[3];
  for (int i = 0; i < 3; ++i) {
    const double at = (origin[i] + direction[i] * enter + 1) * n / 2;
    const int outer = direction[i] > 0 ? 0 : n - 1;
    v[i] = i == axis ? outer : std::clamp(static_cast<int>(std::floor(at)), 0, n - 1);
    const double plane = 2.0 * (v[i] + (direction[i] > 0 ? 1 : 0)) / n - 1;
    next[i] = (plane - origin[i]) / direction[i];
    step[i] = std::abs(2.0 / n / direction[i]);
  }
  for (;;) {
    if (grid.at(static_cast<unsigned>(v[0]), static_cast<unsigned>(v[1]), static_cast<unsigned>(v[2])))
      return {true, axis, {v[0], v[1], v[2]}};
    axis = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
    v[axis] += direction[axis] > 0 ? 1 : -1;
    if (v[axis] < 0 || v[axis] >= n) return {};
    next[axis] += step[axis];
  }
}

float float_of(std::uint32_t bits) {
  float f;
  std::memcpy(&f, &bits, sizeof f);
  return f;
}

}  // namespace

TEST_CASE("svo_walk: with all errata off a frame of the dragon is that of a binary64 walk through its voxels", "[svo_core]") {
  constexpr int resolution = 32;
  const svo_image image = read_svo(RTUSIM_SOURCE_DIR "/testbench/golden/svo/models/dragon_32.svo");
  const voxel_grid grid = voxels_of(image, resolution);
  const std::vector<cell> cubes = cubes_of(image, resolution);
  const word_view words{image.words.data(), static_cast<std::uint32_t>(image.words.size()), (1u << 20) - 1};
  const svo_walk walk{svo_core_params{}};
  const raster size;
  const std::vector<job_packet> packets = camera_jobs({}, size, {}, 0);
  REQUIRE(packets.size() == 1280 * 720);

  std::size_t hits = 0, hit_differs = 0, voxel_differs = 0, axis_differs = 0;
  numeric::float_to_fixed_stats stats;
  for (const job_packet& packet : packets) {
    traversal_job job;
    job.job_word = packet.job_word;
    double origin[3], direction[3];
    for (unsigned i = 0; i < 3; ++i) {
      job.t0[i] = numeric::float_to_fixed(packet.t0[i], {}, {}, stats);
      job.t1[i] = numeric::float_to_fixed(packet.t1[i], {}, {}, stats);
      const double mirror = job.direction_bits() >> i & 1 ? -1 : 1;
      direction[i] = mirror * 2 / (static_cast<double>(float_of(packet.t1[i])) - float_of(packet.t0[i]));
      origin[i] = mirror * -1 - direction[i] * float_of(packet.t0[i]);
    }
    const svo_outcome got = walk(job, words);
    const reference_hit wanted = step_through(grid, origin, direction);
    hits += wanted.hit;
    hit_differs += got.hit != wanted.hit;
    if (!got.hit || !wanted.hit) continue;
    const unsigned slot = got.child ^ job.direction_bits();
    const cell cube = cubes[got.entry];
    const int half = cube.size / 2;
    const int low[3] = {cube.x + static_cast<int>(slot & 1) * half, cube.y + static_cast<int>(slot >> 1 & 1) * half,
                        cube.z + static_cast<int>(slot >> 2 & 1) * half};
    bool inside = true;
    for (int i = 0; i < 3; ++i) inside = inside && wanted.voxel[i] >= low[i] && wanted.voxel[i] < low[i] + half;
    voxel_differs += !inside;
    axis_differs += got.axis != wanted.axis;
  }
  WARN("of " << packets.size() << " pixels differ: hit " << hit_differs << ", voxel " << voxel_differs << ", axis " << axis_differs);
  CHECK(hits > 100'000);
  constexpr std::size_t allowed = 1280 * 720 / 10'000;  // 0.01 %
  CHECK(hit_differs < allowed);
  CHECK(voxel_differs < allowed);
  CHECK(axis_differs < allowed);
}

}  // namespace rtusim
