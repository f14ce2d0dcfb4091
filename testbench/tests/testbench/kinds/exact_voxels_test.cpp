#include "testbench/tests/exact_voxels.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "modules/svo_core/svo_kind.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/replay.h"
#include "testbench/tests/in_child.h"

/// Whole designs of voxel cores without errata against every filled cube of a small octree, in every pace.
namespace rtusim {
namespace {

/// A word of 16.16 as binary32; of at most 24 bits it is exact.
std::uint32_t binary32_bits(std::int64_t word) {
  const auto value = static_cast<float>(std::ldexp(static_cast<double>(word), -16));
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// As text, by the jobs' order.
using results = std::vector<std::string>;

void note(results& all, const traversal_result& any) {
  const auto& r = static_cast<const voxel_result&>(any);
  all.at(r.job_word & job_id_mask) = fmt::format("hit {} t {} axis {} sign {}", static_cast<int>(r.hit), r.t_hit,
                                                 static_cast<int>(r.normal_axis), static_cast<int>(r.normal_sign));
}

results simulate(const design& d, const test::model& m, const std::vector<job_packet>& jobs, pace p) {
  std::istringstream lines(in_child([&] {
    const surroundings s;
    results all(jobs.size());
    simulation sim(d, s, svo_contents(m.image.words), jobs, p);
    sim.board().on_result([&](cycle, const traversal_result& r, std::uint64_t) { note(all, r); });
    sim.run();
    return fmt::format("{}\n", fmt::join(all, "\n"));
  }));
  results all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  return all;
}

results replayed(const design& d, const test::model& m, const std::vector<job_packet>& jobs) {
  results all(jobs.size());
  replay(d, {}, svo_walker(d.of<svo_kind>(), m.image.words), jobs, 2,
         [&](cycle, const traversal_result& r, std::uint64_t) { note(all, r); });
  return all;
}

}  // namespace

TEST_CASE("exact voxels: designs give the nearest cube ahead, its distance and the face that is seen, in every pace", "[system]") {
  test::rng random(401);
  unsigned hits = 0, misses = 0, inside = 0, upper_faces = 0;
  for (int round = 0; round < 20; ++round) {
    const test::model m = test::random_model(random);
    design d;
    d.rtu.cores = 1 + random() % 5;
    d.scheduler_.select = random() % scheduler_policies::count;
    std::vector<job_packet> jobs;
    results wanted;
    while (jobs.size() < 200) {
      traversal_job job = test::random_slabs(random, 8 + random() % 10, m.n);
      test::move(random, job, m, static_cast<test::start>(random() % test::near_the_greatest_word), d.of<svo_kind>().format);
      bool touches = false, exact = true;
      for (unsigned i = 0; i < 3; ++i) exact = exact && std::max(std::abs(job.t0[i]), std::abs(job.t1[i])) < 1 << 24;
      const auto hit = test::nearest(job, m, false, touches);
      if (touches || !exact) continue;
      job_packet& p = jobs.emplace_back();
      p.job_word = job.direction_bits() << job_id_bits | static_cast<std::uint32_t>(jobs.size() - 1);
      for (unsigned i = 0; i < 3; ++i) {
        p.t0[i] = binary32_bits(job.t0[i]);
        p.t1[i] = binary32_bits(job.t1[i]);
      }
      const auto t = hit ? static_cast<std::int64_t>(std::max<test::int128>(hit->at.enter, 0) / m.n) : 0;
      wanted.push_back(hit ? fmt::format("hit 1 t {} axis {} sign {}", t, hit->at.axis, hit->at.sign) : "hit 0 t 0 axis -1 sign 0");
      (hit ? hits : misses) += 1;
      inside += hit && hit->at.enter < 0;
      upper_faces += hit && hit->at.sign > 0;
    }
    CAPTURE(round, m.n, d.rtu.cores);
    for (const pace p : {pace::skipping, pace::stepped, pace::checked}) {
      CAPTURE(static_cast<int>(p));
      CHECK(simulate(d, m, jobs, p) == wanted);
    }
    CHECK(replayed(d, m, jobs) == wanted);
  }
  CHECK(hits > 500);
  CHECK(misses > 300);
  CHECK(inside > 100);
  CHECK(upper_faces > 150);
}

}  // namespace rtusim
