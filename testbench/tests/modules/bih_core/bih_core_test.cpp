#include "modules/bih_core/bih_core.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "modules/bih_core/bih_walk.h"
#include "modules/config/csv.h"
#include "modules/config/files.h"
#include "modules/timing/waveform.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/modules/triangle_unit/triangle_vectors.h"
#include "testbench/tests/random_bih.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"
#include "testbench/units/unit_harness.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/bih/";
constexpr std::int64_t any_word = std::numeric_limits<std::int64_t>::max();

/// The rays of a golden table, raw, as jobs in its order; the job word is the table's row or pixel.
std::vector<triangle_job> golden_jobs(const csv_table& table, std::size_t count, const char* id) {
  std::vector<triangle_job> jobs(std::min(count, table.rows()));
  for (std::size_t row = 0; row < jobs.size(); ++row) {
    const auto word = [&](const char* name) { return table.number(row, table.column(name), -any_word, any_word); };
    jobs[row].job_word = static_cast<std::uint32_t>(word(id));
    jobs[row].sequence = static_cast<std::uint32_t>(row);
    jobs[row].ray.position = {word("pos_x"), word("pos_y"), word("pos_z")};
    jobs[row].ray.direction = {word("dir_x"), word("dir_y"), word("dir_z")};
    jobs[row].ray.reciprocal = {word("idir_x"), word("idir_y"), word("idir_z")};
  }
  return jobs;
}

/// The pixels of a binary PGM.
std::string pixels_of(const std::string& file) {
  std::istringstream in(config::read_file(file));
  std::string magic;
  unsigned width = 0, height = 0, most = 0;
  in >> magic >> width >> height >> most;
  in.get();
  REQUIRE(magic == "P5");
  REQUIRE(width == 64);
  REQUIRE(height == 48);
  REQUIRE(most == 255);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A core with its intersector, as built.
struct core_with_intersector {
  triangle_pipeline pipeline;
  bih_core core;

  core_with_intersector(const bih_core_params& p, const bih_memory& memory, numeric::divider_kind divider, channel<triangle_job>& in,
                        channel<mesh_result>& out)
      : pipeline("triangle_pipeline", {test::triangles_as_built, {}, divider}, memory.triangles),
        core("bih_core", p, memory, std::make_shared<const bih_tables>(p.widths, memory), 0) {
    core.job_in(in);
    core.result_out(out);
    core.intersector_port(pipeline);
  }
};

constexpr auto pipelined = numeric::divider_kind::pipelined, iterative = numeric::divider_kind::iterative;
constexpr packet_widths core_widths{33, 32, 30, 32, 48};

/// A line of the whole design's table, raw.
struct pair_outcome {
  std::int64_t triangle, hit, u, v, t, clock_out;

  bool operator==(const pair_outcome& o) const {
    return triangle == o.triangle && hit == o.hit && u == o.u && v == o.v && t == o.t && clock_out == o.clock_out;
  }
};

/// The whole design's table, by ray.
std::vector<std::vector<pair_outcome>> golden_pairs(std::size_t rays) {
  const csv_table top(golden + "top_cubepot_k8_64x48_m1.csv.gz");
  std::vector<std::vector<pair_outcome>> pairs(rays);
  const std::array<std::size_t, 7> columns{top.column("ray"), top.column("tri"), top.column("hit"),      top.column("u"),
                                           top.column("v"),   top.column("t"),   top.column("clock_out")};
  for (std::size_t line = 0; line < top.rows(); ++line) {
    std::array<std::int64_t, 7> words;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = top.number(line, columns[i], 0, any_word);
    pairs.at(static_cast<std::size_t>(words[0])).push_back({words[1], words[2], words[3], words[4], words[5], words[6]});
  }
  return pairs;
}

}  // namespace

TEST_CASE("bih_core: traversal, triangle memory and intersector give every line of the whole design", "[bih_core]") {
  const bih_memory memory = read_bih(golden + "scenes/cubepot_k8", 10);
  const auto jobs = golden_jobs(csv_table(golden + "frame_cubepot_k8_64x48_m1.csv.gz"), any_word, "pixel");
  const auto wanted = golden_pairs(jobs.size());
  const triangle_intersector intersect({}, test::triangles_as_built);
  bih_walk walk(test::bih_as_built(), memory);
  std::uint64_t begin = 0;
  for (std::size_t ray = 0; ray < jobs.size(); ++ray) {
    std::vector<pair_outcome> pairs;
    const quantised_ray& r = jobs[ray].ray;
    const bih_outcome o = walk(r, [&](std::uint32_t triangle, std::uint64_t clock) {
      const triangle_outcome found = intersect(r.position, r.direction, memory.triangles.at(triangle));
      const auto word = [](std::uint64_t w) { return static_cast<std::int64_t>(w); };
      pairs.push_back({triangle, found.hit, word(found.u), word(found.v), word(found.t), word(begin + clock + bih_result_latency_cycles)});
    });
    begin += o.cycles();
    CAPTURE(ray);
    REQUIRE(pairs == wanted[ray]);
  }
}

TEST_CASE("bih_core: a frame's rays back to back, their hits in order behind the intersector", "[bih_core]") {
  const bih_memory memory = read_bih(golden + "scenes/cubepot_k8", 10);
  const csv_table frame(golden + "frame_cubepot_k8_64x48_m1.csv.gz");
  const auto jobs = golden_jobs(frame, any_word, "pixel");
  const auto wanted = golden_pairs(jobs.size());
  const std::string picture = pixels_of(golden + "frame_cubepot_k8_64x48_m1.pgm");
  REQUIRE(jobs.size() == 1'382);
  REQUIRE(picture.size() == 64 * 48);
  REQUIRE(std::count(picture.begin(), picture.end(), '\xff') == 570);

  bench<triangle_job, mesh_result> b(jobs);
  core_with_intersector unit(test::bih_as_built(), memory, pipelined, b.in, b.out);
  b.clock.start();
  const auto &entered = b.entered.cycles, &left = b.left.cycles;
  REQUIRE(entered.size() == jobs.size());
  REQUIRE(left.size() == jobs.size());
  std::string hits(picture.size(), '\0');
  for (std::size_t ray = 0; ray < jobs.size(); ++ray) {
    CAPTURE(ray);
    const auto clocks = static_cast<cycle>(frame.number(ray, frame.column("clocks"), 0, any_word));
    if (ray + 1 < jobs.size()) REQUIRE(entered[ray + 1] - entered[ray] == clocks);
    REQUIRE(left[ray] - entered[ray] == clocks + bih_result_latency_cycles + 1);
    const mesh_result& r = b.left.payloads[ray];
    REQUIRE(r.sequence == ray);
    REQUIRE(r.cost == clocks);
    const pair_outcome* nearest = nullptr;
    for (const pair_outcome& p : wanted[ray])
      if (p.hit != 0 && (nearest == nullptr || p.t < nearest->t)) nearest = &p;
    REQUIRE(r.hit == (nearest != nullptr));
    if (nearest != nullptr) {
      REQUIRE(r.triangle == nearest->triangle);
      REQUIRE(r.t_hit == nearest->t);
      REQUIRE(r.u == nearest->u);
      REQUIRE(r.v == nearest->v);
    }
    if (r.hit) hits[r.pixel()] = '\xff';
  }
  CHECK((hits == picture));

  const bih_core::stats stats = unit.core.statistics();
  CHECK(stats.jobs == 1'382);
  CHECK(stats.hits == 570);
  CHECK(stats.cost == 120'918);
  CHECK(static_cast<double>(stats.triangles.pairs) / 120'918 == Approx(0.3918).margin(0.00005));
}

TEST_CASE("bih_core: a waveform shows the traces cycle by cycle, signal for signal", "[bih_core]") {
  const test::scratch_folder folder;
  for (const std::string scene : {"tetra_k1", "cube_k2", "cubepot_k4"}) {
    CAPTURE(scene);
    const csv_table trace(golden + "trace_" + scene + "_400.csv.gz");
    const std::size_t rays = scene == "cube_k2" ? 40 : 20;
    const auto jobs = golden_jobs(csv_table(golden + "bih_" + scene + "_400.csv.gz"), rays, "ray");
    const bih_memory memory = read_bih(golden + "scenes/" + scene, 10);
    const std::string message = in_child([&] {
      bench<triangle_job, mesh_result> b(jobs);
      core_with_intersector unit(test::bih_as_built(), memory, pipelined, b.in, b.out);
      waveform w(folder / (scene + ".vcd"), core_widths);
      b.clock.record(w, 0, never);
      b.clock.start();
      w.close();
      return std::string();
    });
    REQUIRE(message.empty());
    const test::vcd w(folder / (scene + ".vcd"));
    REQUIRE(w.transfers("in").size() == rays);
    CHECK(w.transfers("out").size() == rays);
    CHECK(w.width("bih_core.tmin") == 63);
    for (std::size_t row = 0; row < trace.rows(); ++row) {
      const auto number = [&](const char* name) { return trace.number(row, trace.column(name), -any_word, any_word); };
      const std::uint64_t c = row + 1;  // the first job is accepted in cycle 0
      const auto shown = [&](const char* name) { return w.signed_value(c, std::string("bih_core.") + name); };
      const auto bits = [&](const char* name) { return static_cast<std::int64_t>(w.value(c, std::string("bih_core.") + name)); };
      CAPTURE(row);
      REQUIRE(bih_state_words[w.value(c, "bih_core.state")] == trace.field(row, trace.column("state")));
      REQUIRE(bits("job_word") == number("ray"));
      REQUIRE(bits("done") == number("done"));
      REQUIRE(bits("tri_en") == number("tri_en"));
      REQUIRE(bits("tri_num") == (number("tri_en") != 0 ? number("tri_num") : 0));
      REQUIRE(bits("stack_pos") == number("stack_pos"));
      REQUIRE(bits("we") == number("we"));
      REQUIRE(static_cast<std::int64_t>(w.value(c + 1, "bih_core.mem_addr")) == number("addr3x"));
      for (const char* name : {"tmin", "tmax", "dist0", "dist1"}) {
        CAPTURE(name);
        REQUIRE(shown(name) == number(name));
      }
    }
  }
}

TEST_CASE("bih_core: with rays now and then a waveform shows what the machine does cycle by cycle", "[bih_core]") {
  const test::scratch_folder folder;
  const bih_memory memory = read_bih(golden + "scenes/cube_k2", 10);
  const auto jobs = golden_jobs(csv_table(golden + "bih_cube_k2_400.csv.gz"), 60, "ray");
  for (const auto divider : {pipelined, iterative})
    for (const unsigned gap : {1u, 7u, 40u}) {
      const auto file = folder / fmt::format("{}_{}.vcd", static_cast<int>(divider), gap);
      const std::string message = in_child([&] {
        clock_domain clock("clock_domain", 100);
        source_params source_p;
        source_p.valid = source_params::regime::gap;
        source_p.gap_cycles = gap;
        stream_source<triangle_job> source("source", source_p, jobs);
        stream_sink<mesh_result> sink("sink", {}, jobs.size());
        channel<triangle_job> in("in");
        channel<mesh_result> out("out");
        source.out(in);
        sink.in(out);
        core_with_intersector unit(test::bih_as_built(), memory, divider, in, out);
        waveform w(file, core_widths);
        clock.record(w, 0, never);
        clock.start();
        w.close();
        return std::string();
      });
      REQUIRE(message.empty());
      const test::vcd w(file);
      bih_core_params p = test::bih_as_built();
      if (divider == iterative) p.triangle_interval_cycles = 33;
      bih_machine machine(p, memory);
      std::size_t accepted = 0;
      for (std::uint64_t c = 0; c < w.end(); ++c) {
        CAPTURE(gap, static_cast<int>(divider), c, accepted);
        const auto& r = machine.now();
        const auto shown = [&](const char* name) { return w.signed_value(c, std::string("bih_core.") + name); };
        REQUIRE(w.value(c, "bih_core.state") == static_cast<std::uint64_t>(r.state));
        REQUIRE(w.value(c, "bih_core.mem_addr") == r.address3x);
        REQUIRE(w.value(c, "bih_core.stack_pos") == r.stack_pos);
        REQUIRE(w.value(c, "bih_core.tri_en") == machine.signals().tri_en);
        REQUIRE(w.value(c, "bih_core.done") == machine.signals().done);
        REQUIRE(shown("tmin") == r.tmin);
        REQUIRE(shown("tmax") == r.tmax);
        REQUIRE(shown("dist0") == r.dist0);
        REQUIRE(shown("dist1") == r.dist1);
        machine.step();
        if (w.transfers(c, "in")) machine.start(jobs[accepted++].ray);
      }
      CHECK(accepted == jobs.size());
    }
}

}  // namespace rtusim
