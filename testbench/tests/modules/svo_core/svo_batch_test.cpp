#include "modules/svo_core/svo_batch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "modules/job_manager/job_manager.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/tests/random_scene.h"

namespace rtusim {
namespace {

auto tied(const svo_walked& w) { return std::tie(w.t_hit, w.job_word, w.cost, w.pushes, w.depth, w.axis, w.hit, w.overflow); }

/// One after the other.
std::vector<svo_walked> alone(const svo_core_params& p, const numeric::float_to_fixed_errata& conversion, const word_view& octree,
                              const std::vector<job_packet>& jobs, numeric::float_to_fixed_stats& counted) {
  const numeric::float_to_fixed_converter converter(p.format, conversion);
  const svo_walk walk(p);
  std::vector<svo_walked> all;
  for (const job_packet& packet : jobs) {
    traversal_job job;
    convert(packet, converter, counted, job);
    const svo_outcome o = walk(job, octree);
    all.push_back({o.t_hit, o.job_word, o.cost, o.pushes, o.depth, o.axis, o.hit, o.overflow});
  }
  return all;
}

}  // namespace

TEST_CASE("svo_batch: rays side by side come to what each comes to alone", "[svo_core]") {
  test::rng random(2019);
  const auto coin = [&random] { return random() % 2 == 0; };
  std::uint64_t hits = 0, overflows = 0, rays = 0, pushes = 0, wide = 0;
  const char* const wanted_rounds = std::getenv("RTUSIM_ROUNDS");
  for (int round = 0, rounds = wanted_rounds == nullptr ? 600 : std::max(600, std::atoi(wanted_rounds)); round < rounds; ++round) {
    const svo_core_params p = test::random_core(random);
    const numeric::float_to_fixed_errata conversion{coin(), coin(), coin()};
    const svo_image image = test::random_image(random);
    memory::params reads;
    if (coin()) reads.address_bits = 1 + random() % 20;
    const word_view octree{image.words.data(), static_cast<std::uint32_t>(image.words.size()), (1u << reads.address_bits) - 1};
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0, n = random() % 700; id < n; ++id) {
      jobs.push_back(test::random_packet(random, id));
      jobs.back().job_word |= (random() % 8) << job_id_bits;
      if (random() % 8 == 0) jobs.back().address = random();
    }
    numeric::float_to_fixed_stats wanted_counts, one_by_one_counts, counts;
    const std::vector<svo_walked> wanted = alone(p, conversion, octree, jobs, wanted_counts);
    for (const bool lanes : {false, true}) {
      std::vector<svo_walked> found(jobs.size());
      numeric::float_to_fixed_stats& counted = lanes ? counts : one_by_one_counts;
      svo_batch(p, conversion, octree, lanes)(jobs.data(), jobs.size(), found.data(), counted);
      for (std::size_t i = 0; i < jobs.size(); ++i) {
        CAPTURE(round, i, lanes, p.format.width(), p.stack_depth, p.tm_wrap, p.negative_t);
        REQUIRE(tied(found[i]) == tied(wanted[i]));
      }
      CHECK(std::tie(counted.conversions, counted.overflows, counted.nans, counted.flushed) ==
            std::tie(wanted_counts.conversions, wanted_counts.overflows, wanted_counts.nans, wanted_counts.flushed));
    }
    wide += p.format.width() > 32;
    rays += jobs.size();
    for (const svo_walked& w : wanted) {
      hits += w.hit;
      overflows += w.overflow;
      pushes += w.pushes;
    }
  }
  CHECK(rays > 150'000);
  CHECK(hits > 10'000);
  CHECK(overflows > 100);
  CHECK(pushes > 30'000);
  CHECK(wide > 50);
}

}  // namespace rtusim
