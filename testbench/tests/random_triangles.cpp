#include "testbench/tests/random_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "modules/config/error.h"
#include "scenes/meshes/mesh.h"
#include "scenes/triangles/bih_builder.h"
#include "scenes/triangles/quantised_triangles.h"
#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"
#include "testbench/tests/random_bih.h"

namespace rtusim::test {
namespace {

double uniform(rng& random, double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); }

std::uint32_t binary32_bits(double value) {
  const auto rounded = static_cast<float>(value);
  std::uint32_t bits;
  std::memcpy(&bits, &rounded, sizeof bits);
  return bits;
}

mesh hills(rng& random) {
  mesh m;
  const std::uint32_t across = 1 + random() % 8, along = 1 + random() % 8;
  for (std::uint32_t i = 0; i <= across; ++i)
    for (std::uint32_t j = 0; j <= along; ++j) m.vertices.emplace_back(i + 0.0, uniform(random, 0, 2), j + 0.0);
  for (std::uint32_t i = 0; i < across; ++i)
    for (std::uint32_t j = 0; j < along; ++j) {
      const std::uint32_t a = i * (along + 1) + j, b = a + along + 1;
      m.triangles.push_back({a, b, a + 1});
      m.triangles.push_back({b, b + 1, a + 1});
    }
  return m;
}

mesh loose_triangles(rng& random) {
  mesh m;
  const double spread = std::ldexp(1.0, -static_cast<int>(random() % 8));
  for (std::uint32_t count = 1 + random() % 200; count > 0; --count) {
    const glm::dvec3 first(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1));
    const auto number = static_cast<std::uint32_t>(m.vertices.size());
    m.triangles.push_back({number, number + 1, number + 2});
    for (unsigned i = 0; i < 3; ++i)
      m.vertices.push_back(first + spread * glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
  }
  return m;
}

}  // namespace

design random_triangle_design(rng& random) {
  const auto coin = [&random] { return random() % 2 == 0; };
  design d;
  d.choose<bih_kind>();
  d.rtu.cores = random() % 4 == 0 ? 1 + random() % 24 : 1 + random() % 5;
  d.scheduler_.select = random() % scheduler_policies::count;
  d.result_manager_.valid_withdrawn = coin();
  if (coin()) d.of<bih_kind>().words = random_words(random);
  if (coin()) d.of<bih_kind>().words.reciprocal_bits = random() % 29;
  d.of<bih_kind>().core = random_bih_core(random);
  d.of<bih_kind>().core.address_bits = 9 + random() % 4;
  d.of<bih_kind>().core.rays_in_flight = coin() ? 1 + random() % 4 : 1 + random() % 64;
  d.of<bih_kind>().intersector.errata = coin() ? triangle_errata{} : random_errata(random);
  d.of<bih_kind>().divider.kind = random() % 4 == 0 ? numeric::divider_kind::iterative : numeric::divider_kind::pipelined;
  return d;
}

bih_memory random_triangles(rng& random, const design& d) {
  for (;;) {
    try {
      const quantised_triangles on_grid =
          quantise(random() % 2 == 0 ? hills(random) : loose_triangles(random), d.of<bih_kind>().words, "random");
      std::vector<triangle_box> boxes;
      for (const auto& c : on_grid.corners) {
        triangle_box& box = boxes.emplace_back();
        for (unsigned i = 0; i < 3; ++i) std::tie(box.lower[i], box.upper[i]) = std::minmax({c[0][i], c[1][i], c[2][i]});
      }
      bih_memory memory = build_bih(boxes, 1 + random() % 16, d.of<bih_kind>().core.address_bits, "random");
      memory.triangles = on_grid.triangles;
      memory.corner = on_grid.box;
      return memory;
    } catch (const input_error&) {
      // Flat on a coarse grid, or too large.
    }
  }
}

job_packet random_triangle_packet(rng& random, std::uint32_t id, const design& d, const bih_memory& scene) {
  job_packet p;
  p.job_word = id;
  if (random() % 16 == 0) {
    for (auto* words : {&p.t0, &p.t1})
      for (std::uint32_t& word : *words) word = random();
    return p;
  }
  per_axis<double> origin, direction;
  double sum = 0;
  const bool inside = random() % 4 == 0;
  for (unsigned i = 0; i < 3; ++i) {
    const double side = std::ldexp(static_cast<double>(scene.corner[i]), -static_cast<int>(d.of<bih_kind>().words.n));
    origin[i] = inside ? uniform(random, 0, side) : uniform(random, -2, 3);
    if (random() % 16 == 0) origin[i] = random() % 2 == 0 ? 0 : side;
    direction[i] = random() % 8 == 0 ? uniform(random, -1, 1) : uniform(random, 0, side) - origin[i];
    if (random() % 16 == 0) direction[i] = 0;
    sum += random() % 64 == 0 ? 0 : std::fabs(direction[i]);
  }
  for (unsigned i = 0; i < 3; ++i) {
    p.t0[i] = binary32_bits(origin[i]);
    p.t1[i] = binary32_bits(sum == 0 ? direction[i] : direction[i] / sum);
  }
  return p;
}

}  // namespace rtusim::test
