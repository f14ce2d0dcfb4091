#include "testbench/camera.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <future>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

constexpr double least_depth = 1e-6;  // of near, and of far beyond it: binary64 still tells the two ends of a ray apart
constexpr double most_length = 1e6;

std::uint32_t binary32_bits(double value) {
  const float rounded = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return bits;
}

/// `a` with only its last set bit in x, y, z order (erratum `last_sign_only`).
constexpr std::array<std::uint32_t, 8> last_sign{0, 1, 2, 2, 4, 4, 4, 4};

/// `n` rays side by side: origins and directions in, traversal parameters out.
template <std::size_t n>
struct ray_block {
  double origin[3][n];
  double direction[3][n];
  double t0[3][n];
  double t1[3][n];
  double mirrored[3][n];  // 1 or 0: a double, as a comparison of doubles vectorises to one of its own width

  void compute() {
    double length[n];
    for (std::size_t i = 0; i < n; ++i)
      length[i] = direction[0][i] * direction[0][i] + direction[1][i] * direction[1][i] + direction[2][i] * direction[2][i];
    for (std::size_t i = 0; i < n; ++i) length[i] = std::sqrt(length[i]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < n; ++i) {
        double d = direction[axis][i] / length[i];
        d = d == 0 ? 0.0001 : d;
        const bool negative = d < 0;
        const double o = negative ? -origin[axis][i] : origin[axis][i];
        d = negative ? -d : d;
        mirrored[axis][i] = negative ? 1.0 : 0.0;
        t0[axis][i] = (-1 - o) / d;
        t1[axis][i] = (1 - o) / d;
      }
  }

  job_packet packet(std::size_t i, std::uint32_t job_id, bool last_sign_only, std::uint32_t model_address) const {
    auto a = static_cast<std::uint32_t>(static_cast<std::int32_t>(mirrored[0][i] + 2 * mirrored[1][i] + 4 * mirrored[2][i]));
    if (last_sign_only) a = last_sign[a];
    return {job_id | a << job_id_bits,
            {binary32_bits(t0[0][i]), binary32_bits(t0[1][i]), binary32_bits(t0[2][i])},
            {binary32_bits(t1[0][i]), binary32_bits(t1[1][i]), binary32_bits(t1[2][i])},
            model_address};
  }
};

}  // namespace

job_packet traversal_parameters(const per_axis<double>& origin, const per_axis<double>& direction, std::uint32_t job_id,
                                bool last_sign_only, std::uint32_t model_address) {
  ray_block<1> ray;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ray.origin[axis][0] = origin[axis];
    ray.direction[axis][0] = direction[axis];
  }
  ray.compute();
  return ray.packet(0, job_id & job_id_mask, last_sign_only, model_address);
}

void camera::params::describe(config::section& s) {
  s.real("vertical_fov_degrees", vertical_fov_degrees, {0.001, 179.999}, "degrees", "opening angle from the lower to the upper edge");
  s.real("near", near, {least_depth, most_length}, "world units", "depth of the plane on which rays start");
  s.real("far", far, {2 * least_depth, most_length}, "world units", "depth of the plane through which rays are aimed; beyond near");
  s.vector("position", position, {-most_length, most_length}, "world units", "where the eye is; the model's cube is [-1, 1]^3");
  s.vector("rotation", rotation, {-most_length, most_length}, "rad",
           "turn about y by rotation y, then nod about x by -sin(rotation x) / 2; rotation z must be 0");
}

camera::camera(const params& p, const frame::params& f) : width_(f.width), height_(f.height) {
  if (!(p.far >= p.near + least_depth))
    throw input_error("camera", fmt::format("far = {} where near = {}", p.far, p.near),
                      fmt::format("far at least {} beyond near", least_depth));
  if (p.rotation[2] != 0)
    throw input_error("camera", fmt::format("rotation = [{}, {}, {}]", p.rotation[0], p.rotation[1], p.rotation[2]),
                      "0 for z: this camera turns about x and y alone");

  const double aspect = static_cast<double>(width_) / height_;
  const glm::dmat4 inverse_projection = glm::inverse(glm::perspectiveRH_NO(glm::radians(p.vertical_fov_degrees), aspect, p.near, p.far));
  const double nod = 0.5 * std::sin(p.rotation[0]);
  const double turn = -p.rotation[1];
  // Each line lists columns, as GLM does.
  const glm::dmat3 rotation_x(1, 0, 0, 0, std::cos(nod), std::sin(nod), 0, -std::sin(nod), std::cos(nod));
  const glm::dmat3 rotation_y(std::cos(turn), 0, -std::sin(turn), 0, 1, 0, std::sin(turn), 0, std::cos(turn));
  const glm::dmat3 to_world = glm::transpose(rotation_x * rotation_y);

  const std::size_t padded = (std::size_t{width_} + lanes - 1) / lanes * lanes;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    column_part_[i].resize(padded);
    row_part_[i].resize(height_);
    for (unsigned x = 0; x < padded; ++x) {
      const double clip_x = (x + 0.5) / width_ * 2 - 1;
      column_part_[i][x] = to_world[0][axis] * (inverse_projection[0][0] * clip_x);
    }
    for (unsigned y = 0; y < height_; ++y) {
      const double clip_y = ((height_ - y - 1) + 0.5) / height_ * 2 - 1;
      row_part_[i][y] = to_world[1][axis] * (inverse_projection[1][1] * clip_y);
    }
    for (std::size_t end = 0; end < 2; ++end) {
      const glm::dvec4 q = inverse_projection * glm::dvec4(0, 0, end == 0 ? -1 : 1, 1);
      depth_part_[end][i] = to_world[2][axis] * q.z + p.position[i] * q.w;
      w_[end] = q.w;
    }
  }
}

void camera::rows(unsigned first, unsigned past, bool last_sign_only, std::uint32_t model_address, job_packet* out) const {
  ray_block<lanes> rays;
  for (unsigned y = first; y < past; ++y)
    for (unsigned x = 0; x < width_; x += lanes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double* columns = column_part_[axis].data() + x;
        const double row = row_part_[axis][y];
        const double start_depth = depth_part_[0][axis], end_depth = depth_part_[1][axis];
        const double start_w = w_[0], end_w = w_[1];
        for (std::size_t i = 0; i < lanes; ++i) {
          const double across = columns[i] + row;
          const double start = (across + start_depth) / start_w;
          const double end = (across + end_depth) / end_w;
          rays.origin[axis][i] = start;
          rays.direction[axis][i] = end - start;
        }
      }
      rays.compute();
      const unsigned count = std::min(lanes, width_ - x);
      for (unsigned i = 0; i < count; ++i) *out++ = rays.packet(i, y * width_ + x + i, last_sign_only, model_address);
    }
}

std::vector<job_packet> camera_jobs(const camera::params& p, const frame::params& f, bool last_sign_only, std::uint32_t model_address,
                                    unsigned threads) {
  const camera eye(p, f);
  std::vector<job_packet> jobs(std::size_t{f.width} * f.height);
  const unsigned workers = std::clamp(threads, 1u, f.height);
  const auto share = [&](unsigned worker) {
    const unsigned first = static_cast<unsigned>(std::uint64_t{f.height} * worker / workers);
    const unsigned past = static_cast<unsigned>(std::uint64_t{f.height} * (worker + 1) / workers);
    eye.rows(first, past, last_sign_only, model_address, jobs.data() + std::size_t{first} * f.width);
  };
  std::vector<std::future<void>> others;
  for (unsigned worker = 1; worker < workers; ++worker) others.push_back(std::async(std::launch::async, share, worker));
  share(0);
  for (auto& other : others) other.get();
  return jobs;
}

}  // namespace rtusim
