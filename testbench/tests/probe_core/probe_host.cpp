#include "testbench/tests/probe_core/probe_host.h"

#include <iterator>
#include <utility>

#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/core_bank/figures_of_bank.h"
#include "testbench/kinds/driver.h"
#include "testbench/replay/schedule.h"
#include "testbench/units/unit_harness.h"

namespace rtusim::test {
namespace {

/// What a replay has to know of the cores.
class probe_way {
 public:
  struct walked_ray {
    std::int64_t t_hit;
    std::uint32_t job_word;
    std::uint32_t cost;
    bool hit;
  };
  using jobs_type = job_manager::stats;
  using result_type = traversal_result;
  struct core_sums {
    std::uint64_t hits = 0, cost = 0;

    void add(const walked_ray& ray) {
      hits += ray.hit;
      cost += ray.cost;
    }
  };
  static constexpr bool overlaps = false;

  class walk {
   public:
    explicit walk(const probe_kind& kind) : converter_(kind.jobs.format, kind.jobs.conversion), cost_(kind.core.latency_cycles) {}

    void operator()(const job_packet* jobs, std::size_t count, walked_ray* to, jobs_type& counted) const {
      traversal_job job;
      for (std::size_t i = 0; i < count; ++i) {
        convert(jobs[i], converter_, counted.conversion, job);
        const probe_outcome o = probe(job);
        to[i] = {o.t, job.job_word, cost_, o.hit};
      }
    }

   private:
    numeric::float_to_fixed_converter converter_;
    std::uint32_t cost_;
  };

  explicit probe_way(const design&) {}

  unsigned job_latency_cycles() const { return job_manager::latency_cycles; }
  unsigned rays_in_flight() const { return 1; }
  unsigned result_latency_cycles() const { return 0; }
  void show(unsigned, const walked_ray& ray, traversal_result& r) { r.t_hit = ray.hit ? ray.t_hit : 0; }
  void check(const walked_ray&, unsigned, std::uint32_t, cycle) const {}
  std::vector<named_figures> figures(const jobs_type& jobs, const scheduler_stats& dispatches,
                                     const std::vector<replaying::core_schedule<core_sums, overlaps>>& cores,
                                     const result_manager_stats& results, cycle) const {
    std::vector<probe_core::stats> all;
    for (const auto& core : cores)
      all.push_back({core.jobs, core.sums.hits, core.idle_cycles, core.sums.cost, core.jobs + core.waited_cycles});
    return figures_of_bank(jobs, dispatches, all, results);
  }
};

class probe_model final : public loaded_model {
 public:
  const memory_contents& memories() const override { return nothing_; }
  std::uint64_t walk_cycles(const design& d, const std::vector<job_packet>& jobs) const override {
    return jobs.size() * d.of<probe_kind>().core.latency_cycles;
  }
  std::unique_ptr<ray_walker> walker(const design& d) const override {
    return std::make_unique<replaying::walker<probe_way>>(d.of<probe_kind>());
  }
  result_keeper keeper(const design&, const std::vector<job_packet>&, frame& picture) const override {
    return [&picture](const traversal_result& r, std::uint64_t latency_cycles) { picture.store(r, latency_cycles); };
  }
  frame::places places(const design&, const std::vector<job_packet>& jobs, const frame& picture) const override {
    frame::places where;
    where.points = points_of(jobs, picture, [](const job_packet& job, double distance) { return point_on_ray(job, distance); });
    return where;
  }
  void describe(nlohmann::ordered_json& inputs) const override {
    inputs["model_cubes"] = 1;
    inputs["model_crc32"] = "00000000";
  }
  std::string size_text() const override { return "the root cube"; }
  std::string_view cores_word() const override { return "probe"; }
  std::string_view log_header() const override { return "cycle,core,job_id,hit,t_hit,cost\n"; }
  void add_log_line(fmt::memory_buffer& to, cycle c, const traversal_result& r) const override {
    fmt::format_to(std::back_inserter(to), "{},{},{},{},{},{}\n", c, r.core, r.job_word, static_cast<int>(r.hit), r.t_hit, r.cost);
  }

 private:
  std::vector<job_packet> camera_jobs(const design& d, const scene& what, unsigned threads, host_figures& host) const override {
    return rtusim::camera_jobs(what.view, what.picture, slab_rules::of({}, d.of<probe_kind>().jobs.format), 0, threads,
                               &host.replaced_components);
  }
  std::vector<job_packet> list_jobs(const design& d, const ray_list& rays, unsigned threads, host_figures& host) const override {
    return rtusim::list_jobs(rays, slab_rules::of({}, d.of<probe_kind>().jobs.format), 0, threads, &host.replaced_components);
  }

  probe_contents nothing_;
};

/// Columns id, t0x .. t0z, t1x .. t1z; outputs hit, t.
void bench_probe_core(const design& d, const unit_files& files) {
  const csv_table table(files.jobs);
  const char* const names[] = {"t0x", "t0y", "t0z", "t1x", "t1y", "t1z"};
  std::vector<traversal_job> jobs(table.rows());
  for (std::size_t row = 0; row < jobs.size(); ++row) {
    jobs[row].sequence = static_cast<std::uint32_t>(row);
    for (unsigned i = 0; i < 6; ++i)
      (i < 3 ? jobs[row].t0 : jobs[row].t1)[i % 3] =
          table.number(row, table.column(names[i]), -(std::int64_t{1} << 31), std::int64_t{1} << 31);
  }
  std::vector<std::vector<std::int64_t>> results;
  if (!jobs.empty()) {
    bench<traversal_job, traversal_result> b(jobs);
    probe_core core("probe_core", d.of<probe_kind>().core, 0);
    core.job_in(b.in);
    core.result_out(b.out);
    b.clock.start();
    for (const traversal_result& r : b.left.payloads) results.push_back({r.hit, r.t_hit});
  }
  write_csv(files.out, table, {"id", "t0x", "t0y", "t0z", "t1x", "t1y", "t1z", "hit", "t"}, {"hit", "t"}, results);
}

}  // namespace

std::unique_ptr<loaded_model> probe_host::load(const design&, const scene&) const { return std::make_unique<probe_model>(); }

std::vector<lone_unit> probe_host::units() const { return {{"probe_core", &bench_probe_core}}; }

}  // namespace rtusim::test
