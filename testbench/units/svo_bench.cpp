#include "testbench/units/svo_bench.h"

#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/float_to_fixed/float_to_fixed.h"
#include "modules/formats/svo_image.h"
#include "modules/svo_core/svo_kind.h"
#include "testbench/units/unit_harness.h"

namespace rtusim {
namespace {

constexpr std::int64_t least_word = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest_word = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t greatest_uint32 = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void bench_svo_core(const design& d, const unit_files& files) {
  const svo_kind& kind = d.of<svo_kind>();
  const svo_image image = read_svo(files.model, {kind.memory_.address_bits, most_stack_frames});
  const csv_table table(files.jobs);
  const svo_core_params params = kind.core_with_format();
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
    bench<traversal_job, voxel_result> b(jobs);
    memory words("memory", kind.memory_, image.words);
    svo_core core("svo_core", params, 0);
    core.job_in(b.in);
    core.result_out(b.out);
    core.memory_port(words);
    b.clock.start();
    for (std::size_t row = 0; row < jobs.size(); ++row) {
      const voxel_result& r = b.left.payloads[row];
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
    float_to_fixed converter("float_to_fixed", {d.of<svo_kind>().format, d.of<svo_kind>().conversion});
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

}  // namespace rtusim
