// Every unit alone between two ends, against the contract of timing that it gives itself, whatever stalls, in every pace.

#include "modules/timing/unit_timing.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/bih_core/bih_core.h"
#include "modules/bih_core/bih_kind.h"
#include "modules/config/error.h"
#include "modules/float_to_fixed/float_to_fixed.h"
#include "modules/job_manager/job_manager.h"
#include "modules/job_manager/triangle_job_manager.h"
#include "modules/memory/memory.h"
#include "modules/result_manager/result_manager.h"
#include "modules/scheduler/scheduler.h"
#include "modules/svo_core/svo_core.h"
#include "modules/t_div/t_div.h"
#include "modules/timing/clock_domain.h"
#include "modules/timing/waveform.h"
#include "modules/triangle_unit/triangle_pipeline.h"
#include "modules/triangle_unit/triangle_unit.h"
#include "testbench/bench/stream.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random_scene.h"
#include "testbench/tests/random_triangles.h"
#include "testbench/tests/scratch.h"
#include "testbench/units/unit_harness.h"

namespace rtusim {
namespace {

using json = nlohmann::json;

/// Takes an item, is busy for some cycles, and is ready again: what a junction allows behind it.
template <class T>
class busy_sink final : public unit {
 public:
  rv_in<T> in{"in"};

  busy_sink(const sc_core::sc_module_name& name, std::uint32_t seed, std::uint64_t expected) : unit(name), random_(seed), left_(expected) {}

  void arrives(channel_base&) override {
    if (--left_ == 0) domain().stop();
    book_edge(std::max(now() + 1, now() + random_() % 9));
  }
  void booked_edge() override { in->offer_ready(offer::always_from(now() + 1)); }

 private:
  void reset() override { in->offer_ready(offer::always_from(0)); }
  // Ready in the cycle after the edge that offers it.
  bool level(const channel_base&) const override { return in->ready().asserts(next_edge()); }
  void trace(waveform&) const override {}

  test::rng random_;
  std::uint64_t left_;
};

enum class taker : std::uint8_t { always, busy, lfsr, never };

struct ends {
  source_params::regime source = source_params::regime::always;
  taker sink = taker::always;
};
struct run_way {
  pace how = pace::skipping;
  std::uint32_t shuffle = 0;
};

/// A unit bound to its two channels, with whatever it needs beside them.
struct bound {
  std::shared_ptr<void> parts;
  unit* dut = nullptr;
};

template <class T>
std::uint32_t cost_of(const T& payload) {
  if constexpr (std::is_base_of_v<traversal_result, T>)
    return payload.cost;
  else
    return 0;
}

json stats_of(channel_base& ch) {
  const channel_stats s = ch.stats();
  return {s.transferred, s.starved, s.back_pressured, s.idle};
}

/// What a stream through a unit looks like from outside, in a process of its own.
template <class In, class Out>
json observe(const std::vector<In>& items, const ends& e, const run_way& way, const std::function<bound(channel<In>&, channel<Out>&)>& make,
             const packet_widths& widths) {
  const std::string text = in_child([&] {
    clock_domain clock("clock_domain", 100);
    source_params source_p;
    source_p.valid = e.source;
    source_p.gap_cycles = 3;
    source_p.interval_cycles = 7;
    sink_params sink_p;
    sink_p.ready = e.sink == taker::lfsr    ? sink_params::regime::lfsr
                   : e.sink == taker::never ? sink_params::regime::blocked
                                            : sink_params::regime::always;
    stream_source<In> source("source", source_p, items);
    std::unique_ptr<stream_sink<Out>> sink;
    std::unique_ptr<busy_sink<Out>> busy;
    channel<In> in("in");
    channel<Out> out("out");
    const bound unit_of = make(in, out);
    source.out(in);
    if (e.sink == taker::busy) {
      busy = std::make_unique<busy_sink<Out>>("sink", 3, items.size());
      busy->in(out);
    } else {
      sink = std::make_unique<stream_sink<Out>>("sink", sink_p, items.size());
      sink->in(out);
    }
    recorder<In> entered;
    recorder<Out> left;
    in.observe(entered, 0);
    out.observe(left, 0);
    // How often the input was ready, by whether the output's consumer was, while the output was valid.
    std::uint64_t ready[2][2] = {};
    if (way.how != pace::skipping)
      clock.set_watcher([&](cycle c) {
        if (out.valid_level(c)) ++ready[out.ready_level()][in.ready_level()];
      });
    clock.set_pace(way.how);
    clock.shuffle_units(way.shuffle);
    clock.set_watchdog(3'000);
    std::unique_ptr<waveform> w;
    const test::scratch_folder folder;
    if (way.how == pace::stepped) {
      w = std::make_unique<waveform>(folder / "w.vcd", widths);
      clock.record(*w, 0, never);
    }
    bool stuck = false;
    try {
      clock.start();
    } catch (const simulation_error& error) {
      if (std::string(error.what()).find("no transfer in the") == std::string::npos) throw;
      stuck = true;
    }
    std::vector<std::uint32_t> costs;
    for (const Out& o : left.payloads) costs.push_back(cost_of(o));
    const unit_timing t = unit_of.dut->timing().value();
    json j{{"entered", entered.cycles},
           {"left", left.cycles},
           {"costs", costs},
           {"stuck", stuck},
           {"end", clock.next_edge()},
           {"stats", {stats_of(in), stats_of(out)}},
           {"ready", {{ready[0][0], ready[0][1]}, {ready[1][0], ready[1][1]}}},
           {"cut", w ? w->cut_values() : 0},
           {"latency", t.latency_cycles},
           {"interval", t.interval_cycles},
           {"beside_cost", t.beside_cost},
           {"capacity", t.capacity},
           {"valid_passes", t.valid_passes},
           {"ready_passes", t.ready_passes}};
    return j.dump();
  });
  CAPTURE(text);
  REQUIRE(text.rfind("error: ", 0) == text.npos);
  return json::parse(text);
}

/// How a unit's surroundings may stall it: all ways, or those that a junction allows.
std::vector<ends> all_ends(bool junction) {
  std::vector<ends> all;
  using regime = source_params::regime;
  for (const regime source : {regime::always, regime::gap, regime::paced, regime::lfsr})
    for (const taker sink : {taker::always, taker::busy, taker::lfsr})
      if (!junction || (source != regime::lfsr && sink != taker::lfsr)) all.push_back({source, sink});
  return all;
}

template <class In, class Out>
void hold_to_contract(const std::vector<In>& items, const packet_widths& widths,
                      const std::function<bound(channel<In>&, channel<Out>&)>& make, bool junction = false) {
  std::uint64_t least_latency = never, least_interval = never, passed = 0, apart = 0;
  json contract;
  for (const ends& e : all_ends(junction)) {
    CAPTURE(static_cast<int>(e.source), static_cast<int>(e.sink));
    const json skipped = observe(items, e, {pace::skipping, 0}, make, widths);
    contract = skipped;
    const auto entered = skipped["entered"].get<std::vector<cycle>>(), left = skipped["left"].get<std::vector<cycle>>();
    const auto costs = skipped["costs"].get<std::vector<std::uint64_t>>();
    REQUIRE(!skipped["stuck"].get<bool>());
    REQUIRE(entered.size() == items.size());
    REQUIRE(left.size() == items.size());
    const std::uint64_t latency = contract["latency"], interval = contract["interval"];
    for (std::size_t k = 0; k < items.size(); ++k) {
      const std::uint64_t cost = contract["beside_cost"].get<bool>() ? costs[k] : 0;
      CAPTURE(k, entered[k], left[k], cost);
      REQUIRE(left[k] >= entered[k] + latency + cost);
      least_latency = std::min(least_latency, left[k] - entered[k] - cost);
      if (k + 1 == items.size()) continue;
      REQUIRE(entered[k + 1] >= entered[k] + interval + cost);
      least_interval = std::min(least_interval, entered[k + 1] - entered[k] - cost);
    }
    for (const json& s : skipped["stats"]) {
      REQUIRE(s[0] == items.size());
      REQUIRE(s[0].get<cycle>() + s[1].get<cycle>() + s[2].get<cycle>() + s[3].get<cycle>() == skipped["end"].get<cycle>());
    }
    // Skipped edges are as those that are done, offers as the registers, the order of calls changes nothing, no traced word is too wide.
    for (const run_way& way : {run_way{pace::stepped, 0}, {pace::stepped, 17}, {pace::checked, 0}, {pace::skipping, 23}}) {
      CAPTURE(static_cast<int>(way.how), way.shuffle);
      const json other = observe(items, e, way, make, widths);
      REQUIRE(other["entered"] == skipped["entered"]);
      REQUIRE(other["left"] == skipped["left"]);
      REQUIRE(other["costs"] == skipped["costs"]);
      REQUIRE(other["stats"] == skipped["stats"]);
      REQUIRE(other["cut"] == 0);
      passed += other["ready"][1][1].get<std::uint64_t>();
      apart += other["ready"][0][1].get<std::uint64_t>();
    }
  }
  CHECK(least_latency == contract["latency"]);
  CHECK(least_interval == contract["interval"]);
  CHECK(contract["valid_passes"] == (contract["latency"] == 0));
  CHECK(contract["ready_passes"] == (passed > 0 && apart == 0));
  const json blocked = observe(items, {source_params::regime::always, taker::never}, {pace::checked, 0}, make, widths);
  CHECK(blocked["stuck"].get<bool>());
  CHECK(blocked["entered"].size() == contract["capacity"]);
}

/// A unit whose ports are called `in` and `out`.
template <class In, class Out, class Unit>
std::function<bound(channel<In>&, channel<Out>&)> pipeline(typename Unit::params p) {
  return [p](channel<In>& in, channel<Out>& out) {
    auto u = std::make_shared<Unit>("unit", p);
    u->in(in);
    u->out(out);
    return bound{u, u.get()};
  };
}

std::vector<job_packet> packets(std::uint32_t count) {
  test::rng random(9);
  std::vector<job_packet> all;
  for (std::uint32_t id = 0; id < count; ++id) all.push_back(test::random_packet(random, id));
  return all;
}

std::vector<traversal_job> voxel_jobs(std::uint32_t count, std::uint32_t words) {
  test::rng random(11);
  std::vector<traversal_job> all;
  for (std::uint32_t k = 0; k < count; ++k) {
    all.push_back(test::random_job(random, numeric::fixed_format{}, words));
    all.back().sequence = k;
  }
  return all;
}

}  // namespace

TEST_CASE("contract: job_manager, triangle_job_manager, float_to_fixed", "[timing]") {
  const std::vector<job_packet> jobs = packets(70);
  const job_manager::params voxels;
  hold_to_contract(jobs, {voxels.format.width()}, pipeline<job_packet, traversal_job, job_manager>(voxels));

  triangle_job_manager::params triangles;
  triangles.corner = {1 << 20, 1 << 21, 1 << 19};
  const quantisation& q = triangles.words;
  hold_to_contract(packets(200), {q.n + 3, q.m, q.n, q.m, q.m + q.reciprocal_bits},
                   pipeline<job_packet, triangle_job, triangle_job_manager>(triangles));

  std::vector<std::uint32_t> words;
  for (const job_packet& job : jobs) words.push_back(job.t0[0]);
  hold_to_contract(words, {}, pipeline<std::uint32_t, std::int64_t, float_to_fixed>({}));
}

TEST_CASE("contract: t_div and triangle_unit, pipelined and iterative", "[timing]") {
  test::rng random(5);
  std::vector<division> divisions(50);
  for (division& d : divisions) d = {static_cast<std::int32_t>(random()), static_cast<std::int32_t>(random())};
  const quantisation q;
  std::vector<triangle_request> pairs(50);
  for (triangle_request& r : pairs) {
    for (unsigned i = 0; i < 3; ++i) {
      r.position[i] = random() % (1u << q.n);
      r.direction[i] = static_cast<std::int32_t>(random());
    }
    r.triangle.pp = random() % (1u << q.n);
    r.triangle.e1p = static_cast<std::int32_t>(random());
    r.triangle.r = static_cast<std::uint8_t>(random() % 3);
    r.enable = random() % 4 != 0;
  }
  for (const auto kind : {numeric::divider_kind::pipelined, numeric::divider_kind::iterative}) {
    CAPTURE(static_cast<int>(kind));
    t_div::params divider;
    divider.kind = kind;
    hold_to_contract(divisions, {}, pipeline<division, quotient, t_div>(divider));
    triangle_unit_params intersector;
    intersector.divider = kind;
    hold_to_contract(pairs, {}, pipeline<triangle_request, triangle_result, triangle_unit>(intersector));
  }
}

TEST_CASE("contract: scheduler, result_manager", "[timing]") {
  using jobs_out = std::function<bound(channel<traversal_job>&, channel<traversal_job>&)>;
  for (unsigned policy = 0; policy < scheduler_policies::count; ++policy) {
    CAPTURE(policy);
    const jobs_out make = [policy](channel<traversal_job>& in, channel<traversal_job>& out) {
      auto u = std::make_shared<scheduler<traversal_job>>("unit", scheduler_params{policy}, 1);
      u->job_in(in);
      u->core_out[0](out);
      return bound{u, u.get()};
    };
    hold_to_contract(voxel_jobs(60, 1), {32}, make, true);
  }

  struct parts {
    result_manager<voxel_result> manager;
    std::vector<voxel_result> none;
    std::vector<std::unique_ptr<stream_source<voxel_result>>> sources;
    std::vector<std::unique_ptr<channel<voxel_result>>> channels;
    parts(const result_manager_params& p, unsigned cores) : manager("unit", p, cores) {}
  };
  using results_out = std::function<bound(channel<voxel_result>&, channel<voxel_result>&)>;
  std::vector<voxel_result> results(60);
  for (std::uint32_t k = 0; k < results.size(); ++k) results[k].sequence = k;
  for (const unsigned cores : {1u, 2u, 3u, 7u})
    for (const bool withdrawn : {false, true}) {
      CAPTURE(cores, withdrawn);
      const results_out make = [cores, withdrawn](channel<voxel_result>& in, channel<voxel_result>& out) {
        result_manager_params params;
        params.valid_withdrawn = withdrawn;
        auto p = std::make_shared<parts>(params, cores);
        p->manager.result_out(out);
        p->manager.core_in[0](in);
        for (unsigned i = 1; i < cores; ++i) {
          p->sources.push_back(std::make_unique<stream_source<voxel_result>>(fmt::format("idle_{}", i).c_str(), source_params{}, p->none));
          p->channels.push_back(std::make_unique<channel<voxel_result>>(fmt::format("idle_out_{}", i).c_str()));
          p->sources.back()->out(*p->channels.back());
          p->manager.core_in[i](*p->channels.back());
        }
        return bound{p, &p->manager};
      };
      hold_to_contract(results, {32}, make);
    }
}

TEST_CASE("contract: svo_core, bih_core", "[timing]") {
  struct voxels {
    memory words;
    svo_core core;
    explicit voxels(const std::vector<std::uint32_t>& image) : words("memory", {}, image), core("unit", {}, 0) { core.memory_port(words); }
  };
  // A cube whose lower corner is divided once more.
  const std::vector<std::uint32_t> octree{0x00018301, 0x0000A5A5};
  const std::function<bound(channel<traversal_job>&, channel<voxel_result>&)> make_voxels = [&octree](channel<traversal_job>& in,
                                                                                                      channel<voxel_result>& out) {
    auto v = std::make_shared<voxels>(octree);
    v->core.job_in(in);
    v->core.result_out(out);
    return bound{v, &v->core};
  };
  hold_to_contract(voxel_jobs(40, 1), {32}, make_voxels);

  struct triangles {
    triangle_pipeline pipeline;
    bih_core core;
    triangles(const bih_core_params& p, const triangle_unit_params& intersector, const bih_memory& m)
        : pipeline("pipeline", intersector, m.triangles), core("unit", p, m, std::make_shared<const bih_tables>(p.widths, m), 0) {
      core.intersector_port(pipeline);
    }
  };
  test::rng random(77);
  for (const unsigned rays : {1u, 2u, 16u})
    for (const auto divider : {numeric::divider_kind::pipelined, numeric::divider_kind::iterative}) {
      CAPTURE(rays, static_cast<int>(divider));
      design d;
      d.choose<bih_kind>();
      bih_kind& kind = d.of<bih_kind>();
      kind.core.address_bits = 12;
      kind.core.rays_in_flight = rays;
      kind.divider.kind = divider;
      const bih_memory memory = test::random_triangles(random, d);
      const ray_setup set_up(kind.words, memory.corner);
      std::vector<triangle_job> jobs(40);
      for (std::uint32_t k = 0; k < jobs.size(); ++k) {
        ray_setup_stats ignored;
        set_up(test::random_triangle_packet(random, k, d, memory), ignored, jobs[k]);
        jobs[k].sequence = k;
      }
      const std::function<bound(channel<triangle_job>&, channel<mesh_result>&)> make = [&](channel<triangle_job>& in,
                                                                                           channel<mesh_result>& out) {
        auto t = std::make_shared<triangles>(kind.core_with_widths(), kind.intersector_with_words(), memory);
        t->core.job_in(in);
        t->core.result_out(out);
        return bound{t, &t->core};
      };
      hold_to_contract(jobs, kind.packets(), make);
    }
}

}  // namespace rtusim
