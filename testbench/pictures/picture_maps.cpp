#include "testbench/pictures/picture_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/pictures/grouped.h"

namespace rtusim {
namespace {

constexpr colour miss_of_depth{0.08, 0.12, 0.30};
constexpr double nearest_grey = 0.95, farthest_grey = 0.15;
constexpr double usual_share = 0.995;  // of the rays, that a scale tells apart
constexpr double much_more = 1.25;     // than the usual: the scale is cut
constexpr unsigned parts_an_edge = 32;

using vec = std::array<double, 3>;

vec normalised(const vec& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return length > 0 ? vec{v[0] / length, v[1] / length, v[2] / length} : vec{0, 0, 1};
}

/// A triangle's by the light that falls on it from above; its normal points to the eye.
colour shaded_hit(const frame& f, std::size_t pixel) {
  const frame::pixel& p = f.pixels()[pixel];
  if (f.surfaces().empty()) return grey(p.normal_axis == 0 ? 0.7 : p.normal_axis == 1 ? 0.9 : 0.5);
  const auto& n = f.surfaces()[pixel].normal;
  const double lit = (0.4 * n[0] + 0.8 * n[1] + 0.45 * n[2] + 1) / 2;
  return grey(0.2 + 0.75 * std::clamp(lit, 0.0, 1.0));
}

colour missed_shown(std::uint32_t cost) {
  const double rest = std::min(1.0, std::pow(0.95, (cost - 2.0) / 2.0));
  return {1, rest, rest};
}

/// The span of t_hit over a frame's hits.
struct depth_span {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  explicit depth_span(const frame& f) {
    for (const auto& p : f.pixels())
      if (p.hit) {
        least = std::min<double>(least, p.t_hit);
        most = std::max<double>(most, p.t_hit);
      }
  }
  bool empty() const { return most < least; }
  static colour shown(double far) { return grey(nearest_grey + far * (farthest_grey - nearest_grey)); }
};

/// Where the light comes from: above and left of the eye, on its side of the model. Normals show where the eye is.
vec light_of(const frame& f) {
  double x = 0, z = 0;
  for (std::size_t i = 0; i < f.pixels().size(); ++i)
    if (f.pixels()[i].hit) {
      const auto n = normal_of(f, i);
      x += static_cast<double>(n[0]);
      z += static_cast<double>(n[2]);
    }
  const vec toward = normalised({x, 0, z});
  const vec left{-toward[2], 0, toward[0]};
  return normalised({0.6 * toward[0] + 0.6 * left[0], 0.8, 0.6 * toward[2] + 0.6 * left[2]});
}

/// Sun and sky on clay; the surroundings take their share of the sky.
colour lit_hit(const std::array<float, 3>& normal, double open, const vec& light) {
  constexpr vec clay{0.80, 0.72, 0.62}, sun{0.98, 0.93, 0.84}, sky{0.30, 0.34, 0.40}, ground{0.13, 0.12, 0.11};
  const vec n{static_cast<double>(normal[0]), static_cast<double>(normal[1]), static_cast<double>(normal[2])};
  const double facing = std::max(0.0, n[0] * light[0] + n[1] * light[1] + n[2] * light[2]);
  const double up = (n[1] + 1) / 2;
  colour c{};
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = srgb_of(clay[i] * (facing * sun[i] * (0.5 + 0.5 * open) + (ground[i] + up * (sky[i] - ground[i])) * open));
  return c;
}

std::uint32_t part_of(const frame& f, std::size_t pixel) {
  if (!f.surfaces().empty()) return f.surfaces()[pixel].triangle;
  const auto voxel = voxel_of(f, pixel);
  if (!voxel) return 0;
  const unsigned edge = std::max(1u, f.where().cells / parts_an_edge);
  return (((*voxel)[2] / edge) * parts_an_edge + (*voxel)[1] / edge) * parts_an_edge + (*voxel)[0] / edge;
}

/// A map whose colours stand for a whole number that each traced ray has.
template <class Value>
picture_map scalar_map(const frame& f, std::string title, std::string meaning, const char* unit, colour_scale colours, Value value) {
  std::vector<std::uint32_t> all;
  for (const auto& p : f.pixels())
    if (p.traced()) all.push_back(value(p));
  const auto within = [&](double share) {
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(all.size()))) - 1;
    const auto place = all.begin() + std::max<std::ptrdiff_t>(rank, 0);
    std::nth_element(all.begin(), place, all.end());
    return *place;
  };
  map_scale scale;
  scale.unit = unit;
  scale.shown = [colours](double share) { return on_scale(colours, share); };
  if (!all.empty()) {
    const auto [first, last] = std::minmax_element(all.begin(), all.end());
    const std::uint32_t least = *first, greatest = *last;
    const double low = least, most = greatest, usual = within(usual_share);
    scale.low = low;
    scale.cut = most > low + much_more * (usual - low) && usual > low;
    scale.high = scale.cut ? usual : most;
    scale.figures =
        fmt::format("half within {}, 99 % within {}, all within {}", grouped(within(0.5)), grouped(within(0.99)), grouped(greatest));
  }
  picture_map map;
  map.title = std::move(title);
  map.meaning = std::move(meaning);
  map.at = [&f, value, colours, low = scale.low, high = scale.high](std::size_t pixel) {
    const frame::pixel& p = f.pixels()[pixel];
    if (!p.arrived) return no_result;
    if (!p.traced()) return nothing_met;
    return on_scale(colours, high > low ? (value(p) - low) / (high - low) : 0);
  };
  map.scale = std::move(scale);
  return map;
}

/// A map of colours for hits alone.
template <class Colour>
picture_map hit_map(const frame& f, std::string title, std::string meaning, Colour of_hit) {
  picture_map map;
  map.title = std::move(title);
  map.meaning = std::move(meaning);
  map.at = [&f, of_hit](std::size_t pixel) {
    const frame::pixel& p = f.pixels()[pixel];
    return !p.arrived ? no_result : p.hit ? of_hit(pixel) : nothing_met;
  };
  return map;
}

std::vector<map_swatch> hits_by_axis(const frame& f) {
  if (!f.surfaces().empty()) return {};
  return {{grey(0.7), "face x"}, {grey(0.9), "face y"}, {grey(0.5), "face z"}};
}

picture_map shaded_map(const frame& f) {
  picture_map map =
      hit_map(f, "Shaded", "The nearest surface that each ray hit, by its direction.", [&f](std::size_t i) { return shaded_hit(f, i); });
  map.at = [&f](std::size_t i) { return !f.pixels()[i].arrived ? no_result : f.pixels()[i].hit ? shaded_hit(f, i) : grey(1); };
  map.swatches = hits_by_axis(f);
  return map;
}

picture_map depth_map(const frame& f) {
  const depth_span span(f);
  picture_map map = hit_map(f, "Depth", "How far along its ray each hit lies.", [&f, span](std::size_t i) {
    return depth_span::shown(span.most > span.least ? (static_cast<double>(f.pixels()[i].t_hit) - span.least) / (span.most - span.least)
                                                    : 0);
  });
  map.at = [&f, hit = map.at](std::size_t i) { return f.pixels()[i].arrived && !f.pixels()[i].hit ? miss_of_depth : hit(i); };
  map_scale scale;
  if (!span.empty()) {
    scale.low = span.least;
    scale.high = span.most;
  }
  scale.unit = "world units";
  scale.shown = &depth_span::shown;
  scale.figures = "the model's cube has an edge of 2";
  map.scale = std::move(scale);
  map.swatches = {{miss_of_depth, "no hit"}};
  return map;
}

picture_map normal_map(const frame& f) {
  const auto shown = [](const std::array<float, 3>& n) {
    colour c{};
    for (std::size_t i = 0; i < 3; ++i) c[i] = (static_cast<double>(n[i]) + 1) / 2;
    return c;
  };
  picture_map map = hit_map(f, "Normal", "Which way the surface faces: x in red, y (up) in green, z in blue.",
                            [&f, shown](std::size_t i) { return shown(normal_of(f, i)); });
  map.swatches = {{shown({1, 0, 0}), "+x"}, {shown({-1, 0, 0}), "-x"}, {shown({0, 1, 0}), "+y"}, {shown({0, -1, 0}), "-y"},
                  {shown({0, 0, 1}), "+z"}, {shown({0, 0, -1}), "-z"}, {nothing_met, "no hit"}};
  return map;
}

picture_map cost_map(const frame& f) {
  picture_map map;
  map.title = "Cost of misses";
  map.meaning = "Cycles spent on rays that hit nothing, in red; hits are grey.";
  double most = 2;
  for (const auto& p : f.pixels())
    if (p.traced() && !p.hit) most = std::max<double>(most, p.cost);
  map.at = [&f](std::size_t i) {
    const frame::pixel& p = f.pixels()[i];
    return !p.arrived ? no_result : p.hit ? shaded_hit(f, i) : missed_shown(p.cost);
  };
  map_scale scale;
  constexpr double all_red = 122;  // 0.95^60 is 5 %
  scale.low = 2;
  scale.cut = most > all_red;
  scale.high = std::min(most, all_red);
  scale.unit = "cycles";
  scale.shown = [high = scale.high](double share) { return missed_shown(static_cast<std::uint32_t>(2 + share * (high - 2))); };
  scale.figures = fmt::format("most expensive miss: {} cycles", grouped(static_cast<std::uint64_t>(most)));
  map.scale = std::move(scale);
  map.swatches = hits_by_axis(f);
  return map;
}

picture_map core_map(const frame& f) {
  unsigned cores = 0;
  for (const auto& p : f.pixels())
    if (p.traced()) cores = std::max(cores, p.core + 1u);
  picture_map map;
  map.title = "Core";
  map.meaning = cores > told_apart ? fmt::format("Which core traced the ray, modulo {}.", told_apart) : "Which core traced the ray.";
  map.at = [&f](std::size_t i) {
    const frame::pixel& p = f.pixels()[i];
    return !p.arrived ? no_result : p.traced() ? of_category(p.core) : nothing_met;
  };
  map.look = picture_map::reduction::middle;
  for (unsigned core = 0; core < std::min(cores, told_apart); ++core) map.swatches.push_back({of_category(core), std::to_string(core)});
  return map;
}

picture_map model_map(const frame& f) {
  const unsigned cells = f.where().cells;
  const std::string meaning =
      !f.surfaces().empty() ? "Which triangle was hit, each in a colour of its own."
      : cells > parts_an_edge
          ? fmt::format("Which block of {0} x {0} x {0} voxels was hit, each in a colour of its own.", cells / parts_an_edge)
          : "Which voxel was hit, each in a colour of its own.";
  picture_map map = hit_map(f, "Part of the model", meaning, [&f](std::size_t i) { return of_hash(part_of(f, i)); });
  map.look = picture_map::reduction::samples;
  map.swatches = {{nothing_met, "no hit"}};
  return map;
}

picture_map base_map(const frame& f, picture_kind kind) {
  switch (kind) {
    case picture_kind::lit: return lit_map(f, std::make_shared<surface_shade>(shade_of(f)));
    case picture_kind::depth: return depth_map(f);
    case picture_kind::normal: return normal_map(f);
    case picture_kind::cost: return cost_map(f);
    case picture_kind::heat:
      return scalar_map(f, "Cost", "Cycles that a core worked on the ray, hit or miss.", "cycles", colour_scale::inferno,
                        [](const frame::pixel& p) { return p.cost; });
    case picture_kind::latency:
      return scalar_map(f, "Latency", "Cycles from the ray's arrival in the unit to its result.", "cycles", colour_scale::viridis,
                        [](const frame::pixel& p) { return p.latency_cycles; });
    case picture_kind::wait:
      return scalar_map(f, "Wait", "Of its latency, the cycles in which the ray stood in a queue.", "cycles", colour_scale::viridis,
                        [&f](const frame::pixel& p) { return f.wait_cycles(p); });
    case picture_kind::core: return core_map(f);
    case picture_kind::model: return model_map(f);
    case picture_kind::shaded: return shaded_map(f);
    case picture_kind::sheet:
    case picture_kind::layers: break;
  }
  throw simulation_error("a picture of several maps is no map");
}

}  // namespace

std::optional<std::array<std::uint32_t, 3>> voxel_of(const frame& f, std::size_t pixel) {
  if (f.where().voxels.empty() || !f.pixels()[pixel].hit) return {};
  return f.where().voxels[pixel];
}

picture_map map_of(const frame& f, picture_kind kind) {
  picture_map map = base_map(f, kind);
  const bool numbers =
      kind == picture_kind::heat || kind == picture_kind::latency || kind == picture_kind::wait || kind == picture_kind::core;
  const auto& pixels = f.pixels();
  if (numbers && std::any_of(pixels.begin(), pixels.end(), [](const frame::pixel& p) { return p.arrived && !p.traced(); }))
    map.swatches.push_back({nothing_met, "no ray sent"});
  if (f.arrived() != pixels.size()) map.swatches.push_back({no_result, "no result"});
  return map;
}

picture_map lit_map(const frame& f, std::shared_ptr<const surface_shade> shade) {
  picture_map map = hit_map(f, "Lit", "What the rays hit, in light from the upper left; crevices are darker.",
                            [shade = std::move(shade), light = light_of(f)](std::size_t i) {
                              return lit_hit(shade->normals[i], static_cast<double>(shade->open[i]), light);
                            });
  map.swatches = {{nothing_met, "no hit"}};
  return map;
}

std::string number_text(double value) {
  if (std::fabs(value) >= 1e15 || (value != std::floor(value) && std::fabs(value) < 1000)) return fmt::format("{:.4g}", value);
  return (value < 0 ? "-" : "") + grouped(static_cast<std::uint64_t>(std::fabs(value)));
}

std::string scale_text(const picture_map& map) {
  if (!map.scale) return {};
  return fmt::format("{}: colours from {} to {} {}{}", map.title, number_text(map.scale->low), number_text(map.scale->high),
                     map.scale->unit, map.scale->cut ? " and more" : "");
}

}  // namespace rtusim
