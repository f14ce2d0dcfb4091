#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "modules/formats/packets.h"
#include "scenes/rays/raster.h"

namespace rtusim {

/// What came back for each pixel of a raster.
class frame {
 public:
  static_assert(raster::most_pixels_a_side * raster::most_pixels_a_side - 1 <= job_id_mask);

  /// One pixel's result. A pixel that missed keeps its cost, core and latency; its `t_hit` and normal are 0 and none, whatever the
  /// bus carried.
  struct pixel {
    float t_hit = 0;                   ///< ray parameter of the hit, in world units as directions have length 1
    std::uint32_t latency_cycles = 0;  ///< as told to `store`; the greatest number stands for all beyond it
    std::uint32_t cost = 0;            ///< cycles in all states of the core but IDLE and OUT
    std::uint32_t sequence = 0;        ///< which job of the run it comes from
    std::uint16_t core = 0;
    std::int8_t normal_axis = no_axis;  ///< 0, 1, 2 or no_axis
    std::int8_t normal_sign = 0;        ///< +1 or -1 on that axis, 0 without one
    bool hit = false;
    bool arrived = false;  ///< false: no result came for this pixel

    /// Whether it has the result of a ray: a ray that was sent takes a cycle at least.
    bool traced() const { return arrived && latency_cycles != 0; }
  };
  static_assert(sizeof(pixel) == 24);

  /// Where the hits lie, for pictures that show more than the results' words.
  struct places {
    std::vector<std::array<float, 3>> points;          ///< in world units, a pixel's; of a hit that is nowhere, and of a miss, 0
    std::vector<std::array<std::uint32_t, 3>> voxels;  ///< the finest voxel that a pixel's ray hit; empty where cores trace triangles
    unsigned cells = 0;                                ///< finest voxels an edge of the cube [-1, 1]^3; 0 where cores trace triangles
  };

  /// What a pixel of triangle cores shows.
  struct surface {
    float distance = 0;             ///< from the eye, in world units
    std::array<float, 3> normal{};  ///< of length 1, toward the eye; 0 on a miss
    std::uint32_t triangle = 0;     ///< the mesh's face, see `mesh::face_of`
  };

  /// `fraction_bits`: of the fixed-point t_hit in the results. With `surfaces` every pixel has one.
  frame(const raster& p, unsigned fraction_bits, bool surfaces = false);

  /// Keeps what a triangle core's result shows, at the pixel that its job id names.
  void store(const traversal_result& r, std::uint64_t latency_cycles, const surface& s) {
    const std::uint32_t index = r.pixel();
    if (index >= pixels_.size())
      ++strays_;
    else if (keep(pixels_[index], r, latency_cycles, s.distance))
      surfaces_[index] = s;
  }
  /// No ray is sent for the other pixels, as it would meet nothing: they are misses without cost.
  void leave_out_all_but(const std::vector<job_packet>& jobs);

  /// Keeps a result at the pixel that its job id names. Of several for a pixel it keeps the nearest hit, of equals that of
  /// the earlier job (Espe 2019, sec. 5.3.4: a scene of several octrees). False if it is not kept; counted in
  /// `strays` if the id lies outside the frame.
  bool store(const voxel_result& r, std::uint64_t latency_cycles) {
    pixel* const p = stored(r, latency_cycles);
    if (p != nullptr && r.hit) {
      p->normal_axis = r.normal_axis;
      p->normal_sign = r.normal_sign;
    }
    return p != nullptr;
  }
  /// The same of a result that has no normal.
  bool store(const traversal_result& r, std::uint64_t latency_cycles) { return stored(r, latency_cycles) != nullptr; }
  /// `cycles`: of each ray's latency beside its cost in which it waits for nobody.
  void set_way(std::uint64_t cycles) { way_cycles_ = cycles; }
  /// Of a ray's latency, the cycles in which it waited: for a core, for the core's result buffer, for its turn to leave.
  std::uint32_t wait_cycles(const pixel& p) const {
    return static_cast<std::uint32_t>(p.latency_cycles - std::min<std::uint64_t>(p.latency_cycles, p.cost + way_cycles_));
  }
  /// `where` has a point for every pixel.
  void set_places(places where) { places_ = std::move(where); }

  unsigned width() const { return width_; }
  unsigned height() const { return height_; }
  const pixel& at(unsigned x, unsigned y) const { return pixels_[std::size_t{y} * width_ + x]; }
  const std::vector<pixel>& pixels() const { return pixels_; }
  /// In raster order; empty where cores trace voxels.
  const std::vector<surface>& surfaces() const { return surfaces_; }
  /// Without points unless they were set.
  const places& where() const { return places_; }
  std::uint64_t arrived() const { return arrived_; }  ///< pixels with a result
  std::uint64_t strays() const { return strays_; }    ///< results whose id lies outside the frame

 private:
  /// The pixel that keeps a result; null if none does.
  pixel* stored(const traversal_result& r, std::uint64_t latency_cycles) {
    const std::uint32_t index = r.pixel();
    if (index >= pixels_.size()) {
      ++strays_;
      return nullptr;
    }
    const float t = r.hit ? static_cast<float>(static_cast<double>(r.t_hit) * unit_) : 0.0f;
    return keep(pixels_[index], r, latency_cycles, t) ? &pixels_[index] : nullptr;
  }
  bool keep(pixel& p, const traversal_result& r, std::uint64_t latency_cycles, float distance) {
    if (p.traced() && std::tuple(!r.hit, distance, r.sequence) >= std::tuple(!p.hit, p.t_hit, p.sequence)) return false;
    arrived_ += !p.arrived;
    p.t_hit = distance;
    p.latency_cycles = static_cast<std::uint32_t>(std::min<std::uint64_t>(latency_cycles, ~std::uint32_t{0}));
    p.cost = r.cost;
    p.sequence = r.sequence;
    p.core = r.core;
    p.normal_axis = no_axis;
    p.normal_sign = 0;
    p.hit = r.hit;
    p.arrived = true;
    return true;
  }

  unsigned width_;
  unsigned height_;
  double unit_;  // the worth of t_hit's last bit
  std::vector<pixel> pixels_;
  std::vector<surface> surfaces_;
  places places_;
  std::uint64_t way_cycles_ = 0;
  std::uint64_t arrived_ = 0;
  std::uint64_t strays_ = 0;
};

}  // namespace rtusim
