// What a single ray takes through a unit that does nothing else, read from its waveform.

#include <catch2/catch.hpp>

#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/bih_core/bih_kind.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/bench/simulation.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"

namespace rtusim {
namespace {

std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// The only transfer of a channel.
std::uint64_t only(const test::vcd& w, const std::string& channel) {
  const auto all = w.transfers(channel);
  REQUIRE(all.size() == 1);
  return all[0];
}

struct steps {
  std::uint64_t converted, dispatched, walked, left;  // cycles after the step before
  std::uint64_t cost;
  std::string text() const { return fmt::format("{} {} cost+{} {}", converted, dispatched, walked - cost, left); }
};

/// `shown`: what the unit itself says, conversion and core.
steps steps_of(const design& d, const memory_contents& model, const job_packet& job, std::string& shown) {
  const test::scratch_folder folder;
  const std::vector<job_packet> jobs{job};
  const surroundings s;
  const waveform_window window{folder / "w.vcd", 0, never, {}};
  shown = in_child([&] {
    simulation sim(d, s, model, jobs, pace::skipping, window);
    sim.run();
    return fmt::format("{} {}", sim.dut().bank().job_timing().latency_cycles, sim.dut().bank().core_timing().latency_cycles);
  });
  const test::vcd w(folder / "w.vcd");
  const std::uint64_t accepted = only(w, "job"), pending = only(w, "rtu.pending_job"), dispatched = only(w, "rtu.core_job_0"),
                      walked = only(w, "rtu.core_result_0"), left = only(w, "result");
  REQUIRE(accepted == 0);
  return {pending - accepted, dispatched - pending, walked - dispatched, left - walked, w.value(left, "result.cost")};
}

/// A triangle in a leaf that is the root.
bih_memory one_triangle(const design& d) {
  bih_memory m(d.of<bih_kind>().core.address_bits);
  const std::int64_t edge = (std::int64_t{1} << d.of<bih_kind>().words.n) - 1;
  m.corner = {edge, edge, edge};
  m.triangles.resize(1);
  const bih_words root = make_leaf(1, 1);  // its list at address 1: triangle 0
  for (std::size_t i = 0; i < 3; ++i) m.words[i][0] = root[i];
  check_bih(m, "one triangle");
  return m;
}

}  // namespace

TEST_CASE("rtu: a ray alone takes the documented cycles, cores for voxels", "[rtu]") {
  // The cube is filled in its lower corner alone. One ray meets it, one does not.
  const std::vector<std::uint32_t> octree{0x00000101};
  design d;
  d.rtu.cores = 1;
  for (const float enter : {1.0f, -5.0f}) {
    CAPTURE(enter);
    job_packet job;
    job.t0 = {bits_of(enter), bits_of(enter), bits_of(enter)};
    job.t1 = {bits_of(enter + 2), bits_of(enter + 2), bits_of(enter + 2)};
    std::string shown;
    const steps s = steps_of(d, svo_contents(octree), job, shown);
    CHECK(s.cost > 0);
    CHECK(s.text() == "6 0 cost+1 1");
    CHECK(shown == "6 1");
  }
}

TEST_CASE("rtu: a ray alone takes the documented cycles, cores for triangles", "[rtu]") {
  struct row {
    unsigned n, m, reciprocal_bits, division_drop;
    bool den_wraps;
    const char* text;
    const char* shown;
  };
  // Conversion: 1, the converter's 5, the divider's max(m + C + 1, n + m + 2), 2. Core: 1 in the memory, the intersector's
  // 8 + max(n + 3, m + 1) - T, and 2 where the denominator does not wrap, 1 to the offer.
  for (const row& r : {row{30, 32, 16, 0, true, "72 0 cost+43 1", "72 43"}, row{30, 32, 16, 0, false, "72 0 cost+45 1", "72 45"},
                       row{20, 22, 28, 0, true, "59 0 cost+33 1", "59 33"}, row{20, 22, 16, 5, false, "52 0 cost+30 1", "52 30"},
                       row{16, 24, 16, 0, true, "50 0 cost+35 1", "50 35"}}) {
    CAPTURE(r.n, r.m, r.reciprocal_bits, r.division_drop, r.den_wraps);
    design d;
    d.choose<bih_kind>();
    d.rtu.cores = 1;
    d.of<bih_kind>().core.address_bits = 6;
    d.of<bih_kind>().words.n = r.n;
    d.of<bih_kind>().words.m = r.m;
    d.of<bih_kind>().words.reciprocal_bits = r.reciprocal_bits;
    d.of<bih_kind>().words.division_drop = r.division_drop;
    d.of<bih_kind>().intersector.errata.den_wraps = r.den_wraps;
    const bih_memory model = one_triangle(d);
    job_packet job;  // along z from the middle of the lower side, or away from it
    for (const float down : {1.0f, -1.0f}) {
      job.t0 = {bits_of(0.5f), bits_of(0.5f), bits_of(down < 0 ? -0.25f : 0.0f)};
      job.t1 = {0, 0, bits_of(down)};
      std::string shown;
      const steps s = steps_of(d, bih_contents(model), job, shown);
      CHECK(s.cost > 0);
      CHECK(s.text() == r.text);
      CHECK(shown == r.shown);
    }
  }
}

}  // namespace rtusim
