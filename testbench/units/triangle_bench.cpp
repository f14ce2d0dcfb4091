#include "testbench/units/triangle_bench.h"

#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "modules/bih_core/bih_kind.h"
#include "modules/config/csv.h"
#include "modules/config/error.h"
#include "modules/numeric/fixed_point.h"
#include "modules/t_div/t_div.h"
#include "modules/triangle_unit/triangle_unit.h"
#include "testbench/units/bih_bench.h"
#include "testbench/units/unit_harness.h"

namespace rtusim {
namespace {

constexpr std::int64_t least_word = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t greatest_word = std::numeric_limits<std::int64_t>::max();

/// Reads raw words and cuts them to their width.
class word_reader {
 public:
  explicit word_reader(const csv_table& table) : table_(table) {}

  std::int64_t is_signed(std::size_t row, std::size_t column, unsigned width) {
    const std::int64_t word = table_.number(row, column, least_word, greatest_word);
    return counted(word, numeric::wrap(word, width));
  }
  std::int64_t is_unsigned(std::size_t row, std::size_t column, unsigned width) {
    const std::int64_t word = table_.number(row, column, least_word, greatest_word);
    return counted(word, word & ((std::int64_t{1} << width) - 1));
  }
  void warn() const {
    if (cut_ != 0) fmt::print(stderr, "rtusim: warning: {} words are wider than their registers and were cut\n", cut_);
  }

 private:
  std::int64_t counted(std::int64_t word, std::int64_t kept) {
    cut_ += kept != word;
    return kept;
  }

  const csv_table& table_;
  std::uint64_t cut_ = 0;
};

std::string text(std::uint64_t word) { return std::to_string(word); }

}  // namespace

void bench_t_div(const design& d, const unit_files& files) {
  check_alone(d.of<bih_kind>());
  const csv_table table(files.jobs);
  const t_div::params& params = d.of<bih_kind>().divider;
  const auto n = table.column("n"), divisor = table.column("d");
  std::vector<division> divisions(table.rows());
  word_reader words(table);
  for (std::size_t row = 0; row < divisions.size(); ++row)
    divisions[row] = {words.is_signed(row, n, params.width), words.is_signed(row, divisor, params.width)};
  words.warn();

  std::vector<std::vector<std::string>> results;
  if (!divisions.empty()) {
    bench<division, quotient> b(divisions);
    t_div divider("t_div", params);
    divider.in(b.in);
    divider.out(b.out);
    b.clock.start();
    for (std::size_t row = 0; row < divisions.size(); ++row) {
      RTU_CHECK(b.left.cycles[row] - b.entered.cycles[row], ==, static_cast<cycle>(params.width));
      const quotient& q = b.left.payloads[row];
      results.push_back({text(q.word), text(q.err)});
    }
  }
  write_csv(files.out, table, {"n", "d", "q", "err"}, {"q", "err"}, results);
}

void bench_triangle_unit(const design& d, const unit_files& files) {
  check_alone(d.of<bih_kind>());
  const csv_table table(files.jobs);
  const triangle_unit_params params = d.of<bih_kind>().intersector_with_words();
  const unsigned n = params.words.n, m = params.words.m;
  const unsigned stages = triangle_unit::stages_of(params);
  const std::vector<std::string> inputs{"en", "pos_x", "pos_y", "pos_z", "dir_x", "dir_y", "dir_z", "r",  "pp",
                                        "pq", "d",     "np",    "nq",    "e1p",   "e1q",   "e2p",   "e2q"};
  const std::vector<std::string> outputs{"rdy", "hit", "u", "v", "t"};
  std::vector<std::size_t> columns;
  for (const std::string& name : inputs) columns.push_back(table.column(name));

  std::vector<triangle_request> requests(table.rows());
  word_reader words(table);
  for (std::size_t row = 0; row < requests.size(); ++row) {
    triangle_request& request = requests[row];
    accelerated_triangle& a = request.triangle;
    auto column = columns.begin();
    request.enable = table.number(row, *column++, 0, 1) != 0;
    for (std::int64_t& word : request.position) word = words.is_unsigned(row, *column++, n + 1);
    for (std::int64_t& word : request.direction) word = words.is_signed(row, *column++, m);
    a.r = static_cast<std::uint8_t>(table.number(row, *column++, 0, 3));
    for (std::int64_t* word : {&a.pp, &a.pq}) *word = words.is_unsigned(row, *column++, n);
    a.d = words.is_signed(row, *column++, n + 3);
    for (std::int64_t* word : {&a.np, &a.nq, &a.e1p, &a.e1q, &a.e2p, &a.e2q}) *word = words.is_signed(row, *column++, m);
  }
  words.warn();

  std::vector<std::vector<std::string>> results;
  if (!requests.empty()) {
    bench<triangle_request, triangle_result> b(requests);
    triangle_unit unit("triangle_unit", params);
    unit.in(b.in);
    unit.out(b.out);
    b.clock.start();
    for (std::size_t row = 0; row < requests.size(); ++row) {
      RTU_CHECK(b.left.cycles[row] - b.entered.cycles[row], ==, static_cast<cycle>(stages));
      const triangle_result& r = b.left.payloads[row];
      results.push_back({text(r.rdy), text(r.hit), text(r.u), text(r.v), text(r.t)});
    }
  }
  std::vector<std::string> all = inputs;
  all.insert(all.end(), outputs.begin(), outputs.end());
  write_csv(files.out, table, all, outputs, results);
}

}  // namespace rtusim
