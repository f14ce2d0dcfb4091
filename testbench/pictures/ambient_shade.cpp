#include "testbench/pictures/ambient_shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "testbench/pictures/picture_maps.h"

namespace rtusim {
namespace {

using vec = std::array<float, 3>;

constexpr float reach = 0.22f;  // world units
constexpr float strength = 0.65f;
constexpr unsigned taps = 32;
constexpr unsigned pattern = 4;                   // pixels an edge; taps are turned alike again after so many
constexpr float most_share = 0.2f;                // of the frame's longer side that the reach covers
constexpr float smooth_edge = 3, sharp_edge = 8;  // pixels: voxels up to the one are averaged, from the other on they are not
constexpr float most_rounding = 0.8f;             // the rest is the face's own normal
constexpr int window_radius = 5;                  // pixels
constexpr double pi = 3.14159265358979323846;

vec between(const vec& from, const vec& to) { return {to[0] - from[0], to[1] - from[1], to[2] - from[2]}; }
float dot(const vec& a, const vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The usual distance between the points of two pixels side by side; 0 where no two are.
float pixel_size(const frame& f) {
  std::vector<float> squares;
  for (unsigned y = 0; y < f.height(); ++y)
    for (unsigned x = 0; x + 1 < f.width(); ++x)
      if (f.at(x, y).hit && f.at(x + 1, y).hit) {
        const std::size_t i = std::size_t{y} * f.width() + x;
        const vec way = between(f.where().points[i], f.where().points[i + 1]);
        squares.push_back(dot(way, way));
      }
  if (squares.empty()) return 0;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle);
}

struct offset {
  int x, y;
};
using turned_taps = std::array<std::array<offset, taps>, pattern * pattern>;

/// On a spiral of seven turns, which begins elsewhere for each pixel of the pattern.
turned_taps spirals(float radius) {
  turned_taps all{};
  for (unsigned turn = 0; turn < all.size(); ++turn)
    for (unsigned i = 0; i < taps; ++i) {
      const double share = (i + 0.5) / taps;
      const double angle = 2 * pi * (7 * share + (turn * 7 % 16) / 16.0);
      const double away = std::max(1.0, share * radius);
      all[turn][i] = {static_cast<int>(std::lround(away * std::cos(angle))), static_cast<int>(std::lround(away * std::sin(angle)))};
    }
  return all;
}

/// What the two steps share.
struct shown_points {
  const frame& f;
  int width = static_cast<int>(f.width()), height = static_cast<int>(f.height());
  float size = pixel_size(f);                                                          // of a pixel
  float edge = f.where().cells == 0 ? 0 : 2.0f / static_cast<float>(f.where().cells);  // of a voxel
  float rounding = edge == 0 ? 0 : std::clamp((sharp_edge - edge / size) / (sharp_edge - smooth_edge), 0.0f, 1.0f);

  bool hit(std::size_t i) const { return f.pixels()[i].hit; }
  const vec& point(std::size_t i) const { return f.where().points[i]; }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * f.width() + static_cast<std::size_t>(x); }

  /// Calls `take(pixel, x, y)` for each hit.
  template <class Take>
  void hits(const Take& take) const {
    std::size_t i = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x, ++i)
        if (hit(i)) take(i, x, y);
  }
  /// Calls `take(pixel)` for the hits of a window.
  template <class Take>
  void window(int first_x, int past_x, int first_y, int past_y, const Take& take) const {
    for (int y = std::max(0, first_y); y < std::min(height, past_y); ++y)
      for (int x = std::max(0, first_x); x < std::min(width, past_x); ++x)
        if (hit(at(x, y))) take(at(x, y));
  }
};

void round_voxels(const shown_points& r, std::vector<vec>& normals) {
  const float far = 9 * r.edge * r.edge;
  const std::vector<vec> faces = normals;
  r.hits([&](std::size_t i, int x, int y) {
    vec sum{};
    r.window(x - window_radius, x + window_radius + 1, y - window_radius, y + window_radius + 1, [&](std::size_t near) {
      const vec way = between(r.point(i), r.point(near));
      const float square = dot(way, way);
      if (square >= far) return;
      const float weight = 1 - square / far;
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += weight * faces[near][axis];
    });
    const float length = std::sqrt(dot(sum, sum));
    if (!(length > 0)) return;
    vec& n = normals[i];
    for (std::size_t axis = 0; axis < 3; ++axis) n[axis] += r.rounding * most_rounding * (sum[axis] / length - n[axis]);
    const float mixed = std::sqrt(dot(n, n));
    if (mixed > 0)
      for (float& component : n) component /= mixed;
  });
}

std::vector<float> open_sky(const shown_points& r, const std::vector<vec>& normals) {
  std::vector<float> open(r.f.pixels().size(), 1.0f);
  const float widest = most_share * static_cast<float>(std::max(r.width, r.height));
  const turned_taps offsets = spirals(std::min(reach / r.size, widest));
  constexpr float reach_2 = reach * reach;
  const float rough = std::max(r.size, r.rounding * r.edge);  // what lies lower above the surface is the surface itself
  r.hits([&](std::size_t i, int x, int y) {
    float sum = 0;
    for (const offset& o : offsets[static_cast<std::size_t>(y) % pattern * pattern + static_cast<std::size_t>(x) % pattern])
      r.window(x + o.x, x + o.x + 1, y + o.y, y + o.y + 1, [&](std::size_t tap) {
        const vec way = between(r.point(i), r.point(tap));
        const float square = dot(way, way);
        if (square >= reach_2) return;
        const float near = 1 - square / reach_2;
        sum += near * near * near * std::max(0.0f, dot(way, normals[i]) - rough) * reach / (square + 0.01f * reach_2);
      });
    open[i] = std::max(0.0f, 1 - strength * 5 * sum / taps);
  });

  // The mean over the pattern is free of it; it keeps to the surface.
  std::vector<float> smooth(open);
  const float thick = 4 * rough;
  r.hits([&](std::size_t i, int x, int y) {
    float sum = 0, count = 0;
    r.window(x - 2, x + 2, y - 2, y + 2, [&](std::size_t near) {
      if (dot(normals[i], normals[near]) < 0.8f || std::fabs(dot(normals[i], between(r.point(i), r.point(near)))) > thick) return;
      sum += open[near];
      count += 1;
    });
    if (count > 0) smooth[i] = sum / count;
  });
  return smooth;
}

}  // namespace

surface_shade shade_of(const frame& f) {
  surface_shade shade;
  shade.normals.resize(f.pixels().size());
  for (std::size_t i = 0; i < shade.normals.size(); ++i) shade.normals[i] = normal_of(f, i);
  shade.open.assign(shade.normals.size(), 1.0f);
  if (f.where().points.empty()) return shade;
  const shown_points r{f};
  if (!(r.size > 0) || reach / r.size < 2) return shade;
  if (r.rounding > 0) round_voxels(r, shade.normals);
  shade.open = open_sky(r, shade.normals);
  return shade;
}

}  // namespace rtusim
