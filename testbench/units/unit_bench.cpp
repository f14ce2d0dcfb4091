#include "testbench/units/unit_bench.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/float_to_fixed/float_to_fixed.h"
#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_core.h"
#include "testbench/units/bih_bench.h"
#include "testbench/units/triangle_bench.h"
#include "testbench/units/unit_harness.h"

namespace rtusim {
namespace {

constexpr std::int64_t least_word = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest_word = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t greatest_uint32 = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void bench_svo_core(const design& d, const unit_files& files) {
  const svo_image image = read_svo(files.model, {d.memory_.address_bits, most_stack_frames});
  const csv_table table(files.jobs);
  const svo_core_params params = d.svo_core_params_with_format();
  const auto columns = [&](std::initializer_list<const char*> names) {
    std::vector<std::size_t> at;
    for (const char* name : names) at.push_back(table.column(name));
    return at;
  };
  table.column("id");
  const auto a = table.column("a");
  const auto address = table.column("addr");
  const auto t0 = columns({"t0x", "t0y", "t0z"});
  const auto t1 = columns({"t1x", "t1y", "t1z"});
  std::vector<traversal_job> jobs(table.rows());
  std::uint64_t wrapped = 0;
  for (std::size_t row = 0; row < jobs.size(); ++row) {
    traversal_job& job = jobs[row];
    job.sequence = static_cast<std::uint32_t>(row);
    job.job_word = static_cast<std::uint32_t>(table.number(row, a, 0, 7)) << job_id_bits;
    job.address = static_cast<std::uint32_t>(table.number(row, address, 0, greatest_uint32));
    for (unsigned i = 0; i < 3; ++i) {
      for (const auto& [to, from] : {std::pair{&job.t0[i], t0[i]}, std::pair{&job.t1[i], t1[i]}}) {
        const std::int64_t word = table.number(row, from, least_word, greatest_word);
        *to = numeric::wrap(word, params.format.width());
        wrapped += *to != word;
      }
    }
  }
  if (wrapped != 0) fmt::print(stderr, "rtusim: warning: {} words are wider than {} bits and were cut\n", wrapped, params.format.width());

  std::vector<std::vector<std::int64_t>> results;
  if (!jobs.empty()) {
    bench<traversal_job, traversal_result> b(jobs);
    memory words("memory", d.memory_, image.words);
    svo_core core("svo_core", params, 0);
    core.job_in(b.in);
    core.result_out(b.out);
    core.memory_port(words);
    b.clock.start();
    for (std::size_t row = 0; row < jobs.size(); ++row) {
      const traversal_result& r = b.left.payloads[row];
      RTU_CHECK(r.sequence, ==, jobs[row].sequence);
      const auto states = static_cast<std::int64_t>(b.left.cycles[row] - b.entered.cycles[row]);
      results.push_back({r.hit, r.hit ? r.t_hit : 0, r.hit ? r.normal_axis : no_axis, r.cost, states, r.t_hit, r.normal_axis});
    }
  }
  const std::vector<std::string> outputs{"hit", "t_hit", "normal_axis", "cost", "states", "raw_t_hit", "raw_normal_axis"};
  std::vector<std::string> all{"id", "a", "addr", "t0x", "t0y", "t0z", "t1x", "t1y", "t1z"};
  all.insert(all.end(), outputs.begin(), outputs.end());
  write_csv(files.out, table, all, outputs, results);
}

void bench_float_to_fixed(const design& d, const unit_files& files) {
  const csv_table table(files.jobs);
  table.column("id");
  const auto column = table.column("float_bits");
  std::vector<std::uint32_t> words(table.rows());
  for (std::size_t row = 0; row < words.size(); ++row)
    words[row] = static_cast<std::uint32_t>(table.number(row, column, 0, greatest_uint32));

  std::vector<std::vector<std::int64_t>> results;
  if (!words.empty()) {
    bench<std::uint32_t, std::int64_t> b(words);
    float_to_fixed converter("float_to_fixed", {d.fixed_point, d.float_to_fixed});
    converter.in(b.in);
    converter.out(b.out);
    b.clock.start();
    for (std::size_t row = 0; row < words.size(); ++row) {
      RTU_CHECK(b.left.cycles[row] - b.entered.cycles[row], ==, static_cast<cycle>(numeric::float_to_fixed_stages));
      results.push_back({b.left.payloads[row]});
    }
    if (const auto& s = converter.statistics(); s.overflows + s.nans != 0)
      fmt::print(stderr, "rtusim: warning: {} words lie beyond the fixed-point range, {} are no number\n", s.overflows, s.nans);
  }
  write_csv(files.out, table, {"id", "float_bits", "fixed_raw"}, {"fixed_raw"}, results);
}

void bench_unit(const unit_request& asked) {
  design d;
  config::schema parameters;
  d.describe(parameters);
  if (!asked.architecture.empty()) parameters.read_toml(asked.architecture, design::home);
  for (const std::string& a : asked.assignments) parameters.set(a);
  d.benched = asked.name;
  parameters.check_read();
  if (d.has_triangles() && d.quantisation_.fit_edges)
    throw input_error("quantisation.edge_shift", "auto, but a unit that is alone has no mesh", "a number");
  std::vector<std::filesystem::path> inputs{asked.files.jobs, asked.files.model, asked.architecture};
  std::error_code no_folder;
  for (std::filesystem::directory_iterator i(asked.files.memory, no_folder), end; !no_folder && i != end; i.increment(no_folder))
    inputs.push_back(i->path());
  config::check_writable_apart({asked.files.out}, inputs);
  struct entry {
    const char* name;
    void (*bench)(const design&, const unit_files&);
    bool reads_model;
    bool reads_memory;
  };
  const entry units[] = {{"svo_core", &bench_svo_core, true, false},
                         {"float_to_fixed", &bench_float_to_fixed, false, false},
                         {"t_div", &bench_t_div, false, false},
                         {"triangle_unit", &bench_triangle_unit, false, false},
                         {"bih_core", &bench_bih_core, false, true}};
  const auto found = std::find_if(std::begin(units), std::end(units), [&](const entry& u) { return asked.name == u.name; });
  if (found == std::end(units))
    throw input_error("unit", "unknown unit \"" + asked.name + '"', "svo_core, float_to_fixed, t_div, triangle_unit or bih_core");
  const bool model = !asked.files.model.empty();
  const bool memory_folder = !asked.files.memory.empty();
  if (!found->reads_memory && memory_folder) throw input_error("unit " + asked.name, "--memory", "bih_core, whose memory it is");
  if (found->reads_model && !model) throw input_error("unit " + asked.name, "no --model", "the octree in its memory");
  if (!found->reads_model && model) throw input_error("unit " + asked.name, "--model", "no octree: it has no model memory");
  if (found->reads_memory && !memory_folder) throw input_error("unit " + asked.name, "no --memory", "the folder of its memories");
  found->bench(d, asked.files);
}

}  // namespace rtusim
