#include "modules/svo_core/svo_machine.h"

#include <catch2/catch.hpp>

#include "testbench/tests/random.h"

#include "modules/config/csv.h"
#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_walk.h"
#include "testbench/tests/random_scene.h"

namespace rtusim {
namespace {

const std::string golden = RTUSIM_SOURCE_DIR "/testbench/golden/svo/";
constexpr std::int64_t any_word = std::numeric_limits<std::int64_t>::max();

word_view view_of(const svo_image& image) { return {image.words.data(), static_cast<std::uint32_t>(image.words.size()), (1u << 20) - 1}; }

traversal_job job_of(const csv_table& table, std::size_t row) {
  const auto word = [&](const char* name) { return table.number(row, table.column(name), -any_word, any_word); };
  traversal_job job;
  job.job_word = static_cast<std::uint32_t>(word("a")) << job_id_bits;
  job.address = static_cast<std::uint32_t>(word("addr"));
  job.t0 = {word("t0x"), word("t0y"), word("t0z")};
  job.t1 = {word("t1x"), word("t1y"), word("t1z")};
  return job;
}

}  // namespace

TEST_CASE("svo_machine: 125 jobs cycle by cycle, state for state", "[svo_core]") {
  const svo_image image = read_svo(golden + "models/dragon_32.svo");
  const csv_table jobs(golden + "trace/jobs_dragon_32.csv.gz");
  const csv_table trace(golden + "trace/trace_dragon_32.csv.gz");
  svo_machine machine(test::as_built(), view_of(image));
  const char* const columns[] = {"cost", "entry_idx", "mem_addr", "mem_data", "cur_child_idx", "stack_idx", "t0x", "t0y",
                                 "t0z",  "tmx",       "tmy",      "tmz",      "t1x",           "t1y",       "t1z"};
  REQUIRE(trace.rows() > 4'000);
  std::int64_t id = -1;
  std::size_t job = 0;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const std::int64_t k = trace.number(row, trace.column("k"), 0, any_word);
    if (k == 0) {
      if (row != 0 && machine.now().state == svo_state::out) machine.release();
      id = trace.number(row, trace.column("id"), 0, any_word);
      while (jobs.number(job, jobs.column("id"), 0, any_word) != id) ++job;
    }
    const auto& r = machine.now();
    CAPTURE(id, k);
    REQUIRE(svo_state_words[static_cast<std::size_t>(r.state)] == trace.field(row, trace.column("state")));
    const std::int64_t values[] = {r.cost,       r.top.entry, r.address,   machine.memory_data(), r.top.child,
                                   r.stack_size, r.top.t0[0], r.top.t0[1], r.top.t0[2],           r.top.tm[0],
                                   r.top.tm[1],  r.top.tm[2], r.top.t1[0], r.top.t1[1],           r.top.t1[2]};
    for (std::size_t i = 0; i < std::size(columns); ++i) {
      CAPTURE(columns[i]);
      REQUIRE(values[i] == trace.number(row, trace.column(columns[i]), -any_word, any_word));
    }
    if (k == 0)
      machine.accept(job_of(jobs, job));
    else
      machine.step();
  }
}

TEST_CASE("svo_machine: the walk at once comes to the same as the states one by one", "[svo_core]") {
  test::rng random(11);
  std::uint64_t hits = 0;
  std::uint64_t overflows = 0;
  for (int design = 0; design < 200; ++design) {
    svo_core_params p = test::random_core(random);
    const svo_image image = test::random_image(random);
    const svo_walk walk(p);
    svo_machine machine(p, view_of(image));
    for (int ray = 0; ray < 200; ++ray) {
      const traversal_job job = test::random_job(random, p.format, static_cast<std::uint32_t>(image.words.size()));
      const svo_outcome o = walk(job, view_of(image));
      machine.inherit(0, 0, {});
      machine.accept(job);
      std::uint32_t steps = 0;
      while (machine.now().state != svo_state::out && !machine.overflowed()) {
        machine.step();
        ++steps;
        REQUIRE(steps < 1'000'000);
      }
      CAPTURE(design, ray);
      REQUIRE(machine.overflowed() == o.overflow);
      overflows += o.overflow;
      if (o.overflow) continue;
      hits += o.hit;
      const auto& r = machine.now();
      REQUIRE(r.cost == o.cost);
      REQUIRE(r.hit == o.hit);
      REQUIRE(r.top.child == o.child);
      REQUIRE(r.top.entry == o.entry);
      REQUIRE(r.stack_size == o.depth);
      if (o.hit) {
        REQUIRE(r.result.t_hit == o.t_hit);
        REQUIRE(r.result.axis == o.axis);
      }
      const svo_visits v = visits_of(o);
      REQUIRE(v.init == machine.visits().init);
      REQUIRE(v.eval == machine.visits().eval);
      REQUIRE(v.next == machine.visits().next);
      REQUIRE(v.push == machine.visits().push);
      REQUIRE(v.pop == machine.visits().pop);
    }
  }
  CHECK(hits > 1'000);
  CHECK(overflows > 10);
}

}  // namespace rtusim
