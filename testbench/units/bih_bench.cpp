#include "testbench/units/bih_bench.h"

#include <cstdio>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "modules/bih_core/bih_walk.h"
#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/formats/bih_memory.h"
#include "modules/numeric/fixed_point.h"

namespace rtusim {
namespace {

constexpr std::int64_t least_word = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest_word = std::numeric_limits<std::int64_t>::max();
constexpr std::uint64_t most_text = std::uint64_t{1} << 30;  // bytes of triangle numbers

}  // namespace

void check_alone(const bih_kind& kind) {
  if (kind.words.fit_edges) throw input_error("quantisation.edge_shift", "auto, but a unit that is alone has no mesh", "a number");
}

void bench_bih_core(const design& d, const unit_files& files) {
  check_alone(d.of<bih_kind>());
  const bih_core_params params = d.of<bih_kind>().core_with_widths();
  const quantisation& widths = params.widths;
  const bih_memory hierarchy = read_bih(files.memory, params.address_bits, widths);
  check_bih(hierarchy, files.memory.string(), {true, params.empty_leaf_hangs});
  const csv_table table(files.jobs);
  const auto columns = [&](std::initializer_list<const char*> names) {
    std::vector<std::size_t> at;
    for (const char* name : names) at.push_back(table.column(name));
    return at;
  };
  table.column("ray");
  const auto position = columns({"pos_x", "pos_y", "pos_z"});
  const auto direction = columns({"dir_x", "dir_y", "dir_z"});
  const auto reciprocal = columns({"idir_x", "idir_y", "idir_z"});

  bih_walk walk(params, hierarchy);
  std::vector<std::vector<std::string>> results;
  std::uint64_t wrapped = 0, text = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    quantised_ray ray;
    for (unsigned i = 0; i < 3; ++i) {
      const std::int64_t p = table.number(row, position[i], least_word, greatest_word);
      const std::int64_t r = table.number(row, reciprocal[i], least_word, greatest_word);
      ray.position[i] = p & widths.greatest_coordinate();
      ray.direction[i] = table.number(row, direction[i], least_word, greatest_word);
      ray.reciprocal[i] = numeric::wrap(r, widths.m + widths.reciprocal_bits);
      wrapped += static_cast<std::uint64_t>(ray.position[i] != p) + static_cast<std::uint64_t>(ray.reciprocal[i] != r);
    }
    std::string triangles;
    const bih_outcome o = walk(ray, [&](std::uint32_t triangle, std::uint64_t) {
      fmt::format_to(std::back_inserter(triangles), "{}{}", triangles.empty() ? "" : ";", triangle);
    });
    if (o.overflow) throw bih_stack_overflow("bih_core", row);
    text += triangles.size();
    if (text > most_text)
      throw input_error(fmt::format("{}:{}", files.jobs.string(), row + 2),
                        fmt::format("more than {} bytes of triangle numbers by this ray", most_text), "fewer rays at a time");
    std::vector<std::string>& values = results.emplace_back();
    const bih_visits& v = o.visits;
    for (const std::uint64_t figure : {o.cycles(), v.aabb, v.node, v.inner, v.push, v.pop, v.leaf, std::uint64_t{o.max_stack}, o.triangles})
      values.push_back(std::to_string(figure));
    values.push_back(std::move(triangles));
  }
  if (wrapped != 0)
    fmt::print(stderr, "rtusim: warning: {} words are wider than {} bits (positions) or {} bits (reciprocals) and were cut\n", wrapped,
               widths.n, widths.m + widths.reciprocal_bits);
  const std::vector<std::string> outputs{"clocks", "aabb", "node", "inner", "push", "pop", "leaf", "max_stack", "ntris", "tris"};
  std::vector<std::string> all{"ray", "pos_x", "pos_y", "pos_z", "dir_x", "dir_y", "dir_z", "idir_x", "idir_y", "idir_z"};
  all.insert(all.end(), outputs.begin(), outputs.end());
  write_csv(files.out, table, all, outputs, results);
}

}  // namespace rtusim
