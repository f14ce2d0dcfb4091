#include "testbench/kinds/driver.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <future>

namespace rtusim {
namespace {

std::uint32_t binary32_bits(double value) {
  const float rounded = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return bits;
}

/// `a` with only its last set bit in x, y, z order (erratum `last_sign_only`).
constexpr std::array<std::uint32_t, 8> last_sign{0, 1, 2, 2, 4, 4, 4, 4};

constexpr double instead_of_zero = 0.0001;
constexpr double greatest_turn = 1.0 / 64;  // beyond it a component that the format can't divide by is left as it is
constexpr double rounding = 1 + 1e-6;       // parameters stay below the limit as binary32, too

double value_of(std::uint32_t float_bits) {
  float value;
  std::memcpy(&value, &float_bits, sizeof value);
  return static_cast<double>(value);
}

/// The traversal parameters of `n` rays side by side.
template <std::size_t n>
struct slab_lanes {
  double t0[3][n];
  double t1[3][n];
  double mirrored[3][n];  // 1 or 0: a double, as a comparison of doubles vectorises to one of its own width
  double replaced[n];     // components of a ray that are not its own

  void compute(const double (&origin)[3][n], const double (&direction)[3][n], double limit) {
    const double least_of_one = rounding / limit;  // the least component of a ray from the cube's middle
    std::fill_n(replaced, n, 0.0);
    double length[n];
    for (std::size_t i = 0; i < n; ++i)
      length[i] = direction[0][i] * direction[0][i] + direction[1][i] * direction[1][i] + direction[2][i] * direction[2][i];
    for (std::size_t i = 0; i < n; ++i) length[i] = std::sqrt(length[i]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < n; ++i) {
        double d = direction[axis][i] / length[i];
        const double needed = (1 + std::fabs(origin[axis][i])) * least_of_one;
        const double least = needed <= greatest_turn ? needed : 0;
        const bool is_small = d == 0 || std::fabs(d) < least;
        const double taken = std::max(instead_of_zero, least);
        const bool negative = d < 0;
        d = is_small ? (negative ? -taken : taken) : d;
        replaced[i] += is_small ? 1.0 : 0.0;
        const double o = negative ? -origin[axis][i] : origin[axis][i];
        d = negative ? -d : d;
        mirrored[axis][i] = negative ? 1.0 : 0.0;
        t0[axis][i] = (-1 - o) / d;
        t1[axis][i] = (1 - o) / d;
      }
  }

  job_packet packet(std::size_t i, std::uint32_t job_id, const slab_rules& rules, std::uint32_t model_address) const {
    auto a = static_cast<std::uint32_t>(static_cast<std::int32_t>(mirrored[0][i] + 2 * mirrored[1][i] + 4 * mirrored[2][i]));
    if (rules.last_sign_only) a = last_sign[a];
    return {job_id | a << job_id_bits,
            {binary32_bits(t0[0][i]), binary32_bits(t0[1][i]), binary32_bits(t0[2][i])},
            {binary32_bits(t1[0][i]), binary32_bits(t1[1][i]), binary32_bits(t1[2][i])},
            model_address};
  }
};

/// Calls `rows(first, past)` for parts of a frame's rows, which `threads` share.
template <class Rows>
void share_rows(unsigned height, unsigned threads, const Rows& rows) {
  const unsigned workers = std::clamp(threads, 1u, height);
  const auto share = [&](unsigned worker) {
    const unsigned first = static_cast<unsigned>(std::uint64_t{height} * worker / workers);
    const unsigned past = static_cast<unsigned>(std::uint64_t{height} * (worker + 1) / workers);
    rows(first, past);
  };
  std::vector<std::future<void>> others;
  // Deferred where the system has no thread left.
  constexpr auto how = std::launch::async | std::launch::deferred;
  for (unsigned worker = 1; worker < workers; ++worker) others.push_back(std::async(how, share, worker));
  share(0);
  for (auto& other : others) other.get();
}

/// Whether a ray from `o` along `d` meets the box from 0 to `corner`.
bool meets_box(const double (&o)[3], const double (&d)[3], const per_axis<double>& corner) {
  double enter = 0, leave = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < 0 || o[i] > corner[i]) return false;
      continue;
    }
    const double a = -o[i] / d[i], b = (corner[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// Packets for voxel cores, of anything that gives rays as a camera does.
template <class Rays>
std::vector<job_packet> voxel_packets(const Rays& source, unsigned height, std::size_t count, const slab_rules& rules,
                                      std::uint32_t model_address, unsigned threads, std::uint64_t* replaced) {
  std::vector<job_packet> jobs(count);
  std::atomic<std::uint64_t> components{0};
  share_rows(height, threads, [&](unsigned first, unsigned past) {
    slab_lanes<ray_lanes::count> slabs;
    double changed = 0;
    source.rows(first, past, [&](const ray_lanes& rays, unsigned lanes, std::uint32_t pixel) {
      slabs.compute(rays.origin, rays.direction, rules.limit);
      for (unsigned i = 0; i < lanes; ++i) {
        jobs[pixel + i] = slabs.packet(i, pixel + i, rules, model_address);
        changed += slabs.replaced[i];
      }
    });
    components += static_cast<std::uint64_t>(changed);
  });
  if (replaced != nullptr) *replaced += components;
  return jobs;
}

/// Packets for triangle cores.
template <class Rays>
std::vector<job_packet> triangle_packets(const Rays& source, unsigned height, std::size_t count, const grid_mapping& grid,
                                         direction_norm norm, bool skip_misses, unsigned threads) {
  const double unit = std::ldexp(1.0, -static_cast<int>(grid.n));
  std::vector<job_packet> jobs(count);
  constexpr std::uint32_t not_sent = ~0u;
  share_rows(height, threads, [&](unsigned first, unsigned past) {
    source.rows(first, past, [&](const ray_lanes& rays, unsigned lanes, std::uint32_t pixel) {
      for (unsigned i = 0; i < lanes; ++i) {
        job_packet& job = jobs[pixel + i];
        double o[3], d[3], sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          o[axis] = rays.origin[axis][i] * grid.scale + grid.centre[axis];
          d[axis] = rays.direction[axis][i];
          sum += norm == direction_norm::one ? std::fabs(d[axis]) : d[axis] * d[axis];
        }
        job.job_word = skip_misses && !meets_box(o, d, grid.corner) ? not_sent : pixel + i;
        const double length = norm == direction_norm::one ? sum : std::sqrt(sum);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          job.t0[axis] = binary32_bits(o[axis] * unit);
          job.t1[axis] = binary32_bits(d[axis] / length);
        }
      }
    });
  });
  jobs.erase(std::remove_if(jobs.begin(), jobs.end(), [](const job_packet& j) { return j.job_word == not_sent; }), jobs.end());
  return jobs;
}

}  // namespace

void voxel_driver_params::describe(config::section& s) {
  s.erratum("last_sign_only", last_sign_only, "only the last negative direction component sets its bit of a", "each one does");
  s.erratum("only_zero_replaced", only_zero_replaced, "only a direction component of 0 is replaced before the division",
            "so is one by which the fixed-point format can't divide");
}

void triangle_driver_params::describe(config::section& s) {
  s.choice("norm", norm, norm_words(), "directions are scaled so that their components' magnitudes, or squares, add up to 1");
  s.flag("skip_misses", skip_misses, "rays that miss the box of the scene are not sent");
}

slab_rules slab_rules::of(const voxel_driver_params& p, const numeric::fixed_format& format) {
  slab_rules rules;
  rules.last_sign_only = p.last_sign_only;
  if (!p.only_zero_replaced) rules.limit = std::ldexp(1.0, static_cast<int>(format.integer_bits) - 1);
  return rules;
}

job_packet traversal_parameters(const per_axis<double>& origin, const per_axis<double>& direction, std::uint32_t job_id,
                                const slab_rules& rules, std::uint32_t model_address) {
  const double o[3][1]{{origin[0]}, {origin[1]}, {origin[2]}}, d[3][1]{{direction[0]}, {direction[1]}, {direction[2]}};
  slab_lanes<1> slabs;
  slabs.compute(o, d, rules.limit);
  return slabs.packet(0, job_id & job_id_mask, rules, model_address);
}

std::vector<job_packet> camera_jobs(const camera::params& p, const raster& f, const slab_rules& rules, std::uint32_t model_address,
                                    unsigned threads, std::uint64_t* replaced) {
  return voxel_packets(camera(p, f), f.height, std::size_t{f.width} * f.height, rules, model_address, threads, replaced);
}

std::vector<job_packet> list_jobs(const ray_list& rays, const slab_rules& rules, std::uint32_t model_address, unsigned threads,
                                  std::uint64_t* replaced) {
  return voxel_packets(rays, rays.height(), rays.size(), rules, model_address, threads, replaced);
}

std::vector<job_packet> triangle_jobs(const camera::params& p, const raster& f, const grid_mapping& grid, direction_norm norm,
                                      bool skip_misses, unsigned threads) {
  return triangle_packets(camera(p, f), f.height, std::size_t{f.width} * f.height, grid, norm, skip_misses, threads);
}

std::vector<job_packet> triangle_jobs(const ray_list& rays, const grid_mapping& grid, direction_norm norm, bool skip_misses,
                                      unsigned threads) {
  return triangle_packets(rays, rays.height(), rays.size(), grid, norm, skip_misses, threads);
}

per_axis<float> point_on_ray(const job_packet& job, double distance) {
  per_axis<float> point{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double t0 = value_of(job.t0[axis]), t1 = value_of(job.t1[axis]);
    const double mirrored = -1 + (distance - t0) * (2 / (t1 - t0));
    point[axis] = static_cast<float>((job.job_word >> (job_id_bits + axis) & 1) != 0 ? -mirrored : mirrored);
  }
  return point;
}

per_axis<float> point_on_ray(const job_packet& job, const grid_mapping& grid, double distance) {
  double sum = 0;
  for (const std::uint32_t d : job.t1) sum += value_of(d) * value_of(d);
  const double units = std::ldexp(1.0, static_cast<int>(grid.n)) / grid.scale;
  per_axis<float> point{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    point[axis] = static_cast<float>(value_of(job.t0[axis]) * units - grid.centre[axis] / grid.scale +
                                     distance * (value_of(job.t1[axis]) / std::sqrt(sum)));
  return point;
}

}  // namespace rtusim
