#include "scenes/rays/camera.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "modules/config/error.h"

namespace rtusim {
namespace {

constexpr double least_depth = 1e-6;  // of near, and of far beyond it: binary64 still tells the two ends of a ray apart
constexpr double most_length = 1e6;

glm::dvec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

std::string text(const std::array<double, 3>& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }

/// The eye of an orbit: azimuth 0 looks along -z, 90 along -x; elevation 90 from above.
std::array<double, 3> orbit_eye(const camera::params& p) {
  const double azimuth = glm::radians(p.azimuth_degrees), elevation = glm::radians(p.elevation_degrees);
  const double level = p.distance * std::cos(elevation);
  return {p.target[0] + level * std::sin(azimuth), p.target[1] + p.distance * std::sin(elevation), p.target[2] + level * std::cos(azimuth)};
}

}  // namespace

void camera::params::describe(config::section& s) {
  const auto thesis = [this] { return which == kind::thesis; };
  const auto aimed = [this] { return which != kind::thesis; };
  const auto orbits = [this] { return which == kind::orbit; };
  constexpr auto if_thesis = "camera.kind = thesis", if_aimed = "camera.kind = look_at or orbit", if_orbit = "camera.kind = orbit";
  s.choice("kind", which, kind_words(), "how the camera is placed: as the thesis' driver does, from an eye to a target, or on an orbit");
  s.choice("projection", lens, projection_words(), "rays from one point, or parallel ones").when(aimed, if_aimed);
  s.real("vertical_fov_degrees", vertical_fov_degrees, {0.001, 179.999}, "degrees", "opening angle from the lower to the upper edge")
      .when([this] { return which == kind::thesis || lens == projection::perspective; }, "camera.projection = perspective");
  s.real("height", height, {least_depth, most_length}, "world units", "height of the picture where rays are parallel")
      .when([this] { return which != kind::thesis && lens == projection::orthographic; }, "camera.projection = orthographic");
  s.real("near", near, {least_depth, most_length}, "world units", "depth of the plane on which rays start").when(thesis, if_thesis);
  s.real("far", far, {2 * least_depth, most_length}, "world units", "depth of the plane through which rays are aimed; beyond near")
      .when(thesis, if_thesis);
  s.vector("position", position, {-most_length, most_length}, "world units", "where the eye is; the model's cube is [-1, 1]^3")
      .when([this] { return which != kind::orbit; }, "camera.kind = thesis or look_at");
  s.vector("rotation", rotation, {-most_length, most_length}, "rad",
           "turn about y by rotation y, then nod about x by -sin(rotation x) / 2; rotation z must be 0")
      .when(thesis, if_thesis);
  s.vector("target", target, {-most_length, most_length}, "world units", "what is in the picture's middle").when(aimed, if_aimed);
  s.vector("up", up, {-most_length, most_length}, "world units", "what is upward in the picture, of any length").when(aimed, if_aimed);
  s.real("distance", distance, {least_depth, most_length}, "world units", "from the eye to the target").when(orbits, if_orbit);
  s.real("azimuth_degrees", azimuth_degrees, {-360, 360}, "degrees", "turn of the eye about y: 0 on the +z side, 90 on the +x side")
      .when(orbits, if_orbit);
  s.real("elevation_degrees", elevation_degrees, {-90, 90}, "degrees", "height of the eye: 90 straight above").when(orbits, if_orbit);
}

camera::camera(const params& p, const raster& f) : width_(f.width), height_(f.height) {
  const std::size_t padded = (std::size_t{width_} + ray_lanes::count - 1) / ray_lanes::count * ray_lanes::count;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    column_part_[axis].resize(padded);
    row_part_[axis].resize(height_);
  }
  switch (p.which) {
    case params::kind::thesis: aim_thesis(p); break;
    case params::kind::look_at: aim(p, p.position); break;
    case params::kind::orbit: aim(p, orbit_eye(p)); break;
  }
}

void camera::aim_thesis(const params& p) {
  if (!(p.far >= p.near + least_depth))
    throw input_error("camera", fmt::format("far = {} where near = {}", p.far, p.near),
                      fmt::format("far at least {} beyond near", least_depth));
  if (p.rotation[2] != 0) throw input_error("camera", "rotation = " + text(p.rotation), "0 for z: this camera turns about x and y alone");

  const double aspect = static_cast<double>(width_) / height_;
  const glm::dmat4 inverse_projection = glm::inverse(glm::perspectiveRH_NO(glm::radians(p.vertical_fov_degrees), aspect, p.near, p.far));
  const double nod = 0.5 * std::sin(p.rotation[0]);
  const double turn = -p.rotation[1];
  // Each line lists columns, as GLM does.
  const glm::dmat3 rotation_x(1, 0, 0, 0, std::cos(nod), std::sin(nod), 0, -std::sin(nod), std::cos(nod));
  const glm::dmat3 rotation_y(std::cos(turn), 0, -std::sin(turn), 0, 1, 0, std::sin(turn), 0, std::cos(turn));
  const glm::dmat3 to_world = glm::transpose(rotation_x * rotation_y);

  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    for (unsigned x = 0; x < column_part_[i].size(); ++x) {
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

void camera::aim(const params& p, const std::array<double, 3>& eye) {
  const glm::dvec3 way = vec(p.target) - vec(eye);
  if (!(glm::length(way) >= least_depth)) throw input_error("camera", "target = " + text(p.target) + " in the eye", "a target elsewhere");
  const glm::dvec3 forward = glm::normalize(way);
  // From straight above or below an orbit's up would lie along the view: there it is the way that the azimuth points.
  glm::dvec3 up = vec(p.up);
  if (p.which == params::kind::orbit && glm::length(glm::cross(forward, up)) < least_depth * glm::length(up)) {
    const double azimuth = glm::radians(p.azimuth_degrees);
    up = glm::dvec3(std::sin(azimuth), 0, std::cos(azimuth)) * (forward.y < 0 ? -1.0 : 1.0);
  }
  const glm::dvec3 across = glm::cross(forward, up);
  if (!(glm::length(across) >= least_depth * glm::length(up)) || glm::length(up) == 0)
    throw input_error("camera", "up = " + text(p.up) + " along the view", "another direction");
  const glm::dvec3 right = glm::normalize(across);
  const glm::dvec3 upward = glm::cross(right, forward);

  const bool parallel = p.lens == params::projection::orthographic;
  form_ = parallel ? form::parallel : form::from_point;
  const double half_height = parallel ? p.height / 2 : std::tan(glm::radians(p.vertical_fov_degrees) / 2);
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    for (unsigned x = 0; x < column_part_[i].size(); ++x)
      column_part_[i][x] = right[axis] * ((x + 0.5 - width_ / 2.0) / (height_ / 2.0) * half_height);
    for (unsigned y = 0; y < height_; ++y) row_part_[i][y] = upward[axis] * (-(y + 0.5 - height_ / 2.0) / (height_ / 2.0) * half_height);
    depth_part_[0][i] = eye[i];
    depth_part_[1][i] = forward[axis];
  }
}

}  // namespace rtusim
