#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/bih_core/bih_kind.h"
#include "modules/job_manager/ray_setup.h"
#include "modules/rtu/core_kinds.h"
#include "modules/svo_core/svo_kind.h"
#include "modules/triangle_unit/triangle_intersector.h"
#include "testbench/bench/simulation.h"
#include "testbench/kinds/host_kind.h"
#include "testbench/run/summary.h"
#include "testbench/tests/in_child.h"
#include "testbench/tests/random_scene.h"
#include "testbench/tests/random_streams.h"
#include "testbench/tests/random_triangles.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"

// Every figure of a record, counted again from the jobs, the log and the waveform of the run, by other code than the units' own.
namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
using test::vcd;

/// A result as a log has it.
struct log_line {
  std::uint64_t cycle;
  unsigned core;
  std::uint32_t job_word;
  bool hit;
  std::uint32_t cost;
  std::uint32_t t_hit;  // its low word
};

struct recorded_run {
  std::vector<log_line> log;
  json statistics;
};

/// A run with a waveform of all its cycles.
recorded_run record(const design& d, const surroundings& s, const memory_contents& model, const std::vector<job_packet>& jobs,
                    const std::filesystem::path& waveform) {
  const std::string text = in_child([&] {
    waveform_window window;
    window.file = waveform;
    simulation sim(d, s, model, jobs, pace::skipping, window);
    std::string lines;
    sim.board().on_result([&](cycle c, const traversal_result& r, std::uint64_t) {
      lines +=
          fmt::format("{} {} {} {} {} {}\n", c, r.core, r.job_word, static_cast<int>(r.hit), r.cost, static_cast<std::uint32_t>(r.t_hit));
    });
    sim.run();
    config::report report;
    sim.figures().describe(report);
    return lines + '\0' + report.values().dump();
  });
  const auto split = text.find('\0');
  recorded_run run;
  if (split == std::string::npos) return run;
  std::istringstream lines(text.substr(0, split));
  for (log_line l; lines >> l.cycle >> l.core >> l.job_word >> l.hit >> l.cost >> l.t_hit;) run.log.push_back(l);
  run.statistics = json::parse(text.substr(split + 1));
  return run;
}

/// A ray's way through the unit, from the transfers of the channels.
struct passage {
  std::uint64_t accepted = 0, dispatched = 0, buffered = 0;
  log_line result{};
  std::uint64_t latency() const { return result.cycle - accepted; }
};

/// In the order of the jobs: units keep it up to a core, and a core up to its end.
std::vector<passage> passages_of(const vcd& w, const std::vector<log_line>& log, unsigned cores) {
  std::vector<passage> all;
  for (const std::uint64_t c : w.transfers("job")) all.push_back({c, 0, 0, {}});
  std::vector<std::pair<std::uint64_t, unsigned>> dispatched;
  for (unsigned i = 0; i < cores; ++i)
    for (const std::uint64_t c : w.transfers(fmt::format("rtu.core_job_{}", i))) dispatched.emplace_back(c, i);
  std::sort(dispatched.begin(), dispatched.end());
  REQUIRE(dispatched.size() == all.size());
  std::vector<std::vector<passage*>> of_core(cores);
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].dispatched = dispatched[k].first;
    of_core[dispatched[k].second].push_back(&all[k]);
  }
  std::vector<std::size_t> next(cores, 0);
  for (unsigned i = 0; i < cores; ++i) {
    const auto buffered = w.transfers(fmt::format("rtu.core_result_{}", i));
    REQUIRE(buffered.size() == of_core[i].size());
    for (std::size_t k = 0; k < buffered.size(); ++k) of_core[i][k]->buffered = buffered[k];
  }
  for (const log_line& l : log) of_core.at(l.core).at(next[l.core]++)->result = l;
  return all;
}

json distribution(std::vector<std::uint64_t> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const auto within = [&](std::size_t per_cent) { return values[(n * per_cent + 99) / 100 - 1]; };
  std::map<std::uint64_t, std::uint64_t> counts;
  for (const std::uint64_t v : values) ++counts[v];
  json pairs = json::array();
  for (const auto& [value, count] : counts) pairs.push_back({value, count});
  return {{"mean", static_cast<double>(std::accumulate(values.begin(), values.end(), std::uint64_t{0})) / static_cast<double>(n)},
          {"least", values.front()},
          {"p50", within(50)},
          {"p90", within(90)},
          {"p99", within(99)},
          {"most", values.back()},
          {"histogram", pairs}};
}

std::uint64_t checksum_of(const std::vector<log_line>& log) {
  std::uint64_t sum = 1469598103934665603u;
  const auto mix = [&sum](std::uint64_t word) { sum = (sum ^ word) * 1099511628211u; };
  for (const log_line& l : log) {
    for (const std::uint64_t word : {std::uint64_t{l.job_word}, std::uint64_t{l.hit}, std::uint64_t{l.cost}, l.cycle}) mix(word);
    if (l.hit) mix(l.t_hit);
  }
  return sum;
}

/// How a word fares in a conversion, told by its value.
struct conversion_counts {
  std::uint64_t words = 0, overflows = 0, nans = 0, flushed = 0;
  void add(std::uint32_t word, unsigned integer_bits, unsigned fraction_bits, bool flush_small) {
    float value;
    std::memcpy(&value, &word, sizeof value);
    const double v = static_cast<double>(value), limit = std::ldexp(1.0, static_cast<int>(integer_bits) - 1);
    const double least = std::ldexp(1.0, (flush_small ? 2 : 0) - static_cast<int>(fraction_bits));
    ++words;
    nans += std::isnan(v);
    overflows += v >= limit || v < -limit;
    flushed += v != 0 && std::fabs(v) < least;
  }
  json figures() const { return {{"conversions", words}, {"overflows", overflows}, {"nans", nans}, {"flushed", flushed}}; }
};

/// What the two kinds of cores have in common.
json common_figures(const vcd& w, const std::vector<log_line>& log, const std::vector<passage>& rays, double clock_mhz,
                    std::uint64_t conversion_cycles, std::uint64_t behind_cost) {
  const auto n = static_cast<double>(rays.size());
  const std::uint64_t total = log.back().cycle + 1;
  const auto cycles = static_cast<double>(total);
  json f{{"total_cycles", total},
         {"last_result_cycle", log.back().cycle},
         {"last_accept_cycle", rays.back().accepted},
         {"rays", rays.size()},
         {"hits", std::count_if(log.begin(), log.end(), [](const log_line& l) { return l.hit; })},
         {"cycles_per_ray", cycles / n},
         {"rays_per_cycle", n / cycles},
         {"seconds", cycles / (clock_mhz * 1e6)},
         {"rays_per_second", n * clock_mhz * 1e6 / cycles},
         {"frames_per_second", clock_mhz * 1e6 / cycles},
         {"checksum", fmt::format("{:016x}", checksum_of(log))},
         {"host",
          {{"unsent_rays", 0}, {"replaced_components", 0}, {"duplicate_ids", 0}}}};  // the host sends nothing here: see host_figures_test
  std::vector<std::uint64_t> latencies, costs;
  double dispatch = 0, traversal = 0, buffer = 0, result = 0;
  std::uint64_t most_result = 0;
  for (const passage& p : rays) {
    latencies.push_back(p.latency());
    costs.push_back(p.result.cost);
    const std::uint64_t walked = p.dispatched + p.result.cost + behind_cost;
    dispatch += static_cast<double>(p.dispatched - p.accepted - conversion_cycles);
    traversal += static_cast<double>(walked - p.dispatched);
    buffer += static_cast<double>(p.buffered - walked);
    result += static_cast<double>(p.result.cycle - p.buffered);
    most_result = std::max(most_result, p.result.cycle - p.buffered);
  }
  // Cycles in which a job stands at the scheduler and no core takes it.
  std::uint64_t jobs = 0, waiting = 0, waited = 0, most_waited = 0;
  for (std::uint64_t c = 0; c < total; ++c) {
    if (w.value(c, "rtu.pending_job.valid") == 0) continue;
    if (w.value(c, "rtu.pending_job.ready") == 0) {
      ++waiting;
      continue;
    }
    ++jobs;
    waited += waiting;
    most_waited = std::max(most_waited, std::exchange(waiting, 0));
  }
  f["scheduler"] = {{"jobs", jobs}, {"wait", {{"mean", static_cast<double>(waited) / n}, {"most", most_waited}}}};
  f["result_manager"] = {{"results", rays.size()}, {"wait", {{"mean", result / n}, {"most", most_result}}}};
  f["latency"] = distribution(latencies);
  f["cost"] = distribution(costs);
  f["waits"] = {{"conversion", static_cast<double>(conversion_cycles)},
                {"dispatch", dispatch / n},
                {"traversal", traversal / n},
                {"buffer", buffer / n},
                {"result", result / n}};
  for (const auto& [name, signal] : w.signals()) {
    const auto end = name.rfind(".valid");
    if (end == std::string::npos || end + 6 != name.size()) continue;
    const std::string channel = name.substr(0, end);
    std::uint64_t counts[2][2] = {};
    for (std::uint64_t c = 0; c < total; ++c) ++counts[w.value(c, channel + ".valid")][w.value(c, channel + ".ready")];
    f["channels"][channel.substr(channel.rfind('.') + 1)] = {
        {"transferred", counts[1][1]}, {"starved", counts[0][1]}, {"back_pressured", counts[1][0]}, {"idle", counts[0][0]}};
  }
  return f;
}

/// Sums of the numbers in two trees of figures.
json sum_of(const json& a, const json& b) {
  if (a.is_null()) return b;
  if (!a.is_object()) return a.get<std::uint64_t>() + b.get<std::uint64_t>();
  json all;
  for (const auto& [name, value] : a.items()) all[name] = sum_of(value, b[name]);
  return all;
}

/// Every figure of the one is in the other and has its value, a ratio to the last bits of a double.
void check_equal(const json& counted, const json& recorded) {
  std::vector<std::pair<std::string, json>> left, right;
  flatten(counted, "", left);
  flatten(recorded, "", right);
  std::map<std::string, json> expected(left.begin(), left.end());
  for (const auto& [key, value] : right) {
    CAPTURE(key);
    REQUIRE(expected.count(key) == 1);
    if (value.is_number_float())
      REQUIRE(value.get<double>() == Approx(expected[key].get<double>()).epsilon(1e-12));
    else
      REQUIRE(value == expected[key]);
  }
  REQUIRE(left.size() == right.size());
}

}  // namespace

TEST_CASE("figures: of voxel cores each is what the log and the waveform come to", "[figures]") {
  constexpr std::uint64_t conversion_cycles = 6, offer_behind_cost = 1;  // Espe 2019, app. C.2, C.4
  const test::scratch_folder folder;
  test::rng random(41'207);
  unsigned runs = 0;
  std::uint64_t lost[3] = {};
  while (runs < 20) {
    design d;
    d.rtu.cores = 1 + random() % 7;
    d.scheduler_.select = random() % scheduler_policies::count;
    d.of<svo_kind>().core = test::random_core(random);
    d.of<svo_kind>().format = d.of<svo_kind>().core.format;
    d.of<svo_kind>().conversion = {random() % 2 == 0, random() % 2 == 0, random() % 2 == 0};
    d.result_manager_.valid_withdrawn = random() % 2 == 0;
    const surroundings s = test::random_streams(random);
    const svo_image image = test::random_image(random);
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0, n = 1 + random() % 80; id < n; ++id) jobs.push_back(test::random_packet(random, id));

    const recorded_run run = record(d, s, svo_contents(image.words), jobs, folder / "run.vcd");
    if (run.log.empty()) continue;  // a stack that is too short ends the run
    ++runs;
    CAPTURE(runs, d.rtu.cores);
    const vcd w(folder / "run.vcd");
    REQUIRE(w.end() == run.log.back().cycle + 1);
    const auto rays = passages_of(w, run.log, d.rtu.cores);
    json counted = common_figures(w, run.log, rays, d.rtu.clock_mhz, conversion_cycles, offer_behind_cost);

    conversion_counts conversion;
    for (const job_packet& job : jobs)
      for (const auto& words : {job.t0, job.t1})
        for (const std::uint32_t word : words)
          conversion.add(word, d.of<svo_kind>().format.integer_bits, d.of<svo_kind>().format.fraction_bits,
                         d.of<svo_kind>().conversion.flush_small);
    counted["job_manager"] = {{"jobs", jobs.size()}, {"float_to_fixed", conversion.figures()}};
    lost[0] += conversion.overflows;
    lost[1] += conversion.nans;
    lost[2] += conversion.flushed;

    json all;
    for (unsigned i = 0; i < d.rtu.cores; ++i) {
      std::uint64_t jobs_of = 0, hits = 0, cost = 0, states[8] = {};
      for (const log_line& l : run.log)
        if (l.core == i) {
          ++jobs_of;
          hits += l.hit;
          cost += l.cost;
        }
      for (std::uint64_t c = 0; c < w.end(); ++c) ++states[w.value(c, fmt::format("rtu.core_{}.state", i))];
      const json core{{"jobs", jobs_of},
                      {"hits", hits},
                      {"cost", cost},
                      {"cycles",
                       {{"idle", states[0]},
                        {"init", states[1]},
                        {"eval", states[2]},
                        {"next", states[3]},
                        {"push", states[4]},
                        {"pop", states[5]},
                        {"out", states[6]}}}};
      counted[fmt::format("core_{}", i)] = core;
      all = sum_of(all, core);
    }
    counted["svo_core"] = all;
    // The address of a descriptor is set at the end of INIT and of POP.
    counted["memory"] = {{"fetches", all["cycles"]["init"].get<std::uint64_t>() + all["cycles"]["pop"].get<std::uint64_t>()}};
    check_equal(counted, run.statistics);
  }
  for (const std::uint64_t words : lost) CHECK(words > 0);
}

TEST_CASE("figures: of triangle cores each is what the log and the waveform come to", "[figures]") {
  const test::scratch_folder folder;
  test::rng random(1'957);
  std::uint64_t seen[6] = {};
  for (unsigned round = 0; round < 12; ++round) {
    design d = test::random_triangle_design(random);
    d.rtu.clock_mhz = 100;  // the parser's
    d.rtu.cores = 1 + random() % 4;
    const quantisation& q = d.of<bih_kind>().words;
    const surroundings s = test::random_streams(random);
    const bih_memory model = test::random_triangles(random, d);
    std::vector<job_packet> jobs;
    for (std::uint32_t id = 0, n = 1 + random() % 60; id < n; ++id) jobs.push_back(test::random_triangle_packet(random, id, d, model));

    CAPTURE(round, d.rtu.cores);
    const recorded_run run = record(d, s, bih_contents(model), jobs, folder / "run.vcd");
    REQUIRE(run.log.size() == jobs.size());
    const vcd w(folder / "run.vcd");
    const auto rays = passages_of(w, run.log, d.rtu.cores);
    // One register, 5 stages of the converter, a stage a bit of the wider divider, a product and a sum.
    const std::uint64_t conversion_cycles = 1 + 5 + std::max(q.m + q.reciprocal_bits + 1, q.n + q.m + 2) + 2;
    const std::uint64_t behind_cost = 2 + triangle_unit::stages_of(d.of<bih_kind>().intersector_with_words());
    json counted = common_figures(w, run.log, rays, d.rtu.clock_mhz, conversion_cycles, behind_cost);

    // The rays as the cores have them, and what of them did not fit.
    const ray_setup set_up(q, model.corner);
    const triangle_intersector intersect(q, d.of<bih_kind>().intersector.errata);
    std::vector<triangle_job> set(jobs.size());
    conversion_counts conversion;
    std::uint64_t missed = 0, clipped = 0, flat = 0;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      ray_setup_stats ignored;
      set_up(jobs[k], ignored, set[k]);
      bool outside = false;
      for (unsigned i = 0; i < 3; ++i) {
        conversion.add(jobs[k].t0[i], 16, q.n, false);
        conversion.add(jobs[k].t1[i], 2, q.m - 1, false);
        numeric::float_to_fixed_stats unused;
        const std::int64_t origin = numeric::float_to_fixed(jobs[k].t0[i], {16, q.n}, {}, unused);
        outside |= origin < 0 || origin > model.corner[i];
        flat += set[k].ray.direction[i] == 0;
      }
      missed += set[k].ray.misses_box;
      clipped += outside && !set[k].ray.misses_box;
    }
    counted["job_manager"] = {{"jobs", jobs.size()},
                              {"missed_box", missed},
                              {"clipped", clipped},
                              {"flat_components", flat},
                              {"float_to_fixed", conversion.figures()}};

    json all;
    std::uint64_t deepest = 0;
    for (unsigned i = 0; i < d.rtu.cores; ++i) {
      const std::string name = fmt::format("rtu.core_{}.", i);
      std::uint64_t jobs_of = 0, hits = 0, cost = 0, alone = 0, stack = 0, states[8] = {}, pairs = 0, pair_hits = 0, errors = 0,
                    wrapped = 0;
      for (std::size_t k = 0; k < rays.size(); ++k) {
        const log_line& l = rays[k].result;
        if (l.core != i) continue;
        ++jobs_of;
        hits += l.hit;
        cost += l.cost;
        alone += l.cost == 1;
        for (std::uint64_t c = rays[k].dispatched + 1; c <= rays[k].dispatched + l.cost; ++c) {
          ++states[w.value(c, name + "state")];
          if (w.value(c, name + "tri_en") == 0) continue;
          const auto triangle = static_cast<std::uint32_t>(w.value(c, name + "tri_num"));
          const triangle_outcome o = intersect(set[k].ray.position, set[k].ray.direction, model.triangles.at(triangle));
          ++pairs;
          pair_hits += o.hit;
          errors += o.err;
          wrapped += o.wrapped;
        }
      }
      for (std::uint64_t c = 0; c < w.end(); ++c) stack = std::max(stack, w.value(c, name + "stack_pos"));
      deepest = std::max(deepest, stack);
      const json core{{"jobs", jobs_of},
                      {"hits", hits},
                      {"cost", cost},
                      {"missed_box", alone},
                      {"deepest_stack", stack},
                      {"triangles", {{"pairs", pairs}, {"hits", pair_hits}, {"errors", errors}, {"wrapped", wrapped}}},
                      {"cycles",
                       {{"idle", w.end() - cost},
                        {"aabb", states[0]},
                        {"node", states[1]},
                        {"inner", states[2]},
                        {"push", states[3]},
                        {"pop", states[4]},
                        {"leaf", states[5]}}}};
      all = sum_of(all, core);
      counted[fmt::format("core_{}", i)] = core;
      counted[fmt::format("core_{}", i)]["fill"] = cost == 0 ? 0.0 : static_cast<double>(pairs) / static_cast<double>(cost);
    }
    all["deepest_stack"] = deepest;
    all["fill"] = static_cast<double>(all["triangles"]["pairs"]) / static_cast<double>(all["cost"]);
    counted["bih_core"] = all;
    check_equal(counted, run.statistics);
    std::size_t at = 0;
    for (const std::uint64_t count : {missed, clipped, flat, all["triangles"]["hits"].get<std::uint64_t>(),
                                      all["triangles"]["errors"].get<std::uint64_t>(), all["triangles"]["wrapped"].get<std::uint64_t>()})
      seen[at++] += count;
  }
  for (const std::uint64_t count : seen) CHECK(count > 0);
}

TEST_CASE("figures: `explain` lists those that the units of all kinds report, and no others", "[figures]") {
  std::set<std::string> reported, listed;
  const auto enter = [](std::set<std::string>& to, const std::string& key) {
    static const std::regex core("core_[0-9]+"), channel("^channels\\.[^.]+");
    if (key.rfind("host.", 0) != 0) to.insert(std::regex_replace(std::regex_replace(key, core, "core_N"), channel, "channels.NAME"));
  };
  for (const std::string_view kind : core_words()) {
    std::istringstream keys(in_child([kind] {
      design d;
      d.choose(kind);
      const auto nothing = d.kind().blank_contents();
      const std::vector<job_packet> no_jobs;
      simulation idle(d, {}, *nothing, no_jobs, pace::skipping);
      sc_core::sc_start(sc_core::SC_ZERO_TIME);
      config::report report;
      idle.figures().describe(report);
      std::string lines;
      for (const auto& e : report.entries()) lines += e.key + '\n';
      return lines;
    }));
    for (std::string key; std::getline(keys, key);) enter(reported, key);
  }
  for (const auto& e : all_figures()) enter(listed, e.key);
  CHECK(reported == listed);
  CHECK(listed.size() > 60);
}

}  // namespace rtusim
