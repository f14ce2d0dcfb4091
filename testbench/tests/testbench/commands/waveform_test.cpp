#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/bih_core/bih_params.h"
#include "modules/config/csv.h"
#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/svo_core/svo_params.h"
#include "testbench/kinds/driver.h"
#include "testbench/kinds/triangle_model.h"
#include "testbench/run/job_file.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"

namespace rtusim {
namespace {

using test::check_within;
using test::vcd;

const std::string source = RTUSIM_SOURCE_DIR;
const std::string golden = source + "/testbench/golden/svo/";
constexpr std::int64_t any_word = std::int64_t{1} << 40;

const std::string teapot = source + "/scenes/data/teapot.bpt";
constexpr unsigned teapot_quads = 3;

/// Runs `rtusim run` on jobs of the dragon, or others.
class runner {
 public:
  /// `count` jobs of the small frame from its middle on.
  explicit runner(std::size_t count = 160) {
    const auto all = read_jobs(golden + "sys/jobs_64x36_literal.bin.gz");
    jobs_.assign(all.begin() + 1000, all.begin() + 1000 + static_cast<std::ptrdiff_t>(count));
    write_jobs(path("jobs.bin"), jobs_);
  }
  explicit runner(const std::vector<job_packet>& jobs) : jobs_(jobs) { write_jobs(path("jobs.bin"), jobs_); }

  void design(const std::string& architecture, unsigned cores, bool random_streams) {
    common_ = fmt::format("--arch {}/testbench/architectures/{}.toml --model {}models/dragon_32.svo --set rtu.cores={}", source,
                          architecture, golden, cores);
    if (random_streams) common_ += " --set source.valid=lfsr --set sink.ready=lfsr";
  }
  /// The coarse teapot for triangle cores, at this parser's clock.
  void triangle_design(const std::string& architecture, unsigned cores, bool random_streams, const std::string& also) {
    common_ = fmt::format(
        "--arch {}/testbench/architectures/{}.toml --model {} --set scene.patch_quads={} --set rtu.cores={} "
        "--set rtu.clock_mhz=100 {}",
        source, architecture, teapot, teapot_quads, cores, also);
    if (random_streams) common_ += " --set source.valid=lfsr --set sink.ready=lfsr";
  }
  /// Leaves NAME.csv, NAME.json and, where the options ask for a waveform, NAME.vcd.
  void run(const std::string& name, const std::string& options) const {
    const std::string line = fmt::format("cd {} && {} run {} --jobs jobs.bin --log {}.csv --stats {}.json --quiet {} > text 2>&1",
                                         path("").string(), RTUSIM_BINARY, common_, name, name, options);
    CAPTURE(line);
    const int status = std::system(line.c_str());
    CHECK(config::read_file(path("text")).empty());
    REQUIRE(status == 0);
  }
  vcd waveform(const std::string& name, const std::string& options) const {
    run(name, fmt::format("--vcd {}.vcd {}", name, options));
    return vcd(path(name + ".vcd"));
  }
  vcd whole() const { return waveform("whole", "--pace stepped"); }

  std::string bytes(const std::string& file) const { return config::read_file(path(file)); }
  nlohmann::json statistics(const std::string& name) const {
    auto record = nlohmann::json::parse(bytes(name + ".json"));
    REQUIRE(record.erase("simulator") == 1);
    return record;
  }
  const std::vector<job_packet>& jobs() const { return jobs_; }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  test::scratch_folder folder_;
  std::vector<job_packet> jobs_;
  std::string common_;
};

struct design_point {
  const char* architecture;
  unsigned cores;
};
constexpr design_point designs[] = {{"espe2019_as_built", 1}, {"espe2019_as_built", 4}, {"espe2019_as_built", 16},
                                    {"espe2019", 1},          {"espe2019", 4},          {"espe2019", 16}};

/// Windows of cycles and of jobs against the recording of the whole run, and all outputs against those of a run without.
void check_windows(const runner& r) {
  const vcd whole = r.whole();
  REQUIRE(whole.first() == 0);
  REQUIRE(whole.end() == r.statistics("whole")["statistics"]["total_cycles"].get<std::uint64_t>());
  r.run("plain", "");
  const auto check_unchanged = [&r](const std::string& name) {
    CHECK((r.bytes(name + ".csv") == r.bytes("plain.csv")));
    CHECK(r.statistics(name) == r.statistics("plain"));
  };
  check_unchanged("whole");

  const std::pair<std::uint64_t, std::uint64_t> windows[] = {{300, 420}, {401, 1'000'000}};
  for (const auto& [from, to] : windows) {
    CAPTURE(from, to);
    const vcd window = r.waveform("window", fmt::format("--vcd-from {} --vcd-to {}", from, to));
    CHECK(window.first() == from);
    CHECK(window.end() == std::min(to + 1, whole.end()));
    check_within(window, whole);
    check_unchanged("window");
  }

  const auto accepted = whole.transfers("job");
  const auto left = whole.transfers("result");
  REQUIRE(accepted.size() == r.jobs().size());
  const std::size_t followed[] = {0, 77, r.jobs().size() - 1};
  for (const std::size_t n : followed) {
    const std::uint32_t id = r.jobs()[n].pixel();
    CAPTURE(n, id);
    const vcd window = r.waveform("window", fmt::format("--vcd-job {}", id));
    const auto leaves =
        std::find_if(left.begin(), left.end(), [&](std::uint64_t c) { return (whole.value(c, "result.job_word") & job_id_mask) == id; });
    REQUIRE(leaves != left.end());
    CHECK(window.first() == (n == 0 ? 0 : accepted[n - 1] + 1));
    CHECK(window.end() == *leaves + 1);
    check_within(window, whole);
    check_unchanged("window");
  }
}

/// The jobs of a small frame of the coarse teapot.
std::vector<job_packet> teapot_jobs() {
  const triangle_model model = load_triangles(teapot, {}, 8, 10, teapot_quads);
  camera::params eye;
  eye.which = camera::params::kind::orbit;
  eye.vertical_fov_degrees = 35;
  return triangle_jobs(eye, {20, 12}, model.grid, direction_norm::one, true);
}

/// The channels' counters are those of the statistics.
void check_channels(const vcd& w, const nlohmann::json& statistics) {
  for (const auto& [name, figures] : statistics["statistics"]["channels"].items()) {
    CAPTURE(name);
    const std::string path = w.signals().count(name + ".valid") != 0 ? name : "rtu." + name;
    std::map<std::string, std::uint64_t> counted;
    for (std::uint64_t c = 0; c < w.end(); ++c) {
      REQUIRE(w.value(c, path + ".transfers") == counted["transferred"]);
      const bool valid = w.value(c, path + ".valid") != 0, ready = w.value(c, path + ".ready") != 0;
      ++counted[valid && ready ? "transferred" : ready ? "starved" : valid ? "back_pressured" : "idle"];
    }
    for (const char* kind : {"transferred", "starved", "back_pressured", "idle"}) {
      CAPTURE(kind);
      CHECK(figures[kind] == counted[kind]);
    }
  }
}

}  // namespace

TEST_CASE("waveform: a window of cycles or of a job shows what a recording of the whole run shows, and changes nothing", "[waveform]") {
  runner r;
  for (const auto& [architecture, cores] : designs) {
    CAPTURE(architecture, cores);
    r.design(architecture, cores, true);
    check_windows(r);
  }
}

TEST_CASE("waveform: a window of triangle cores shows what a recording of the whole run shows, and changes nothing", "[waveform]") {
  runner r(teapot_jobs());
  struct row {
    const char* architecture;
    unsigned cores;
    const char* also;
  };
  const row rows[] = {{"hanika2007_as_built", 1, "--set driver.norm=two"},
                      {"hanika2007_as_built", 4, ""},
                      {"hanika2007", 3, "--set t_div.kind=iterative --set bih_core.rays_in_flight=2"},
                      {"hanika2007", 4, "--set bih_core.early_out=true"}};
  for (const row& design : rows) {
    CAPTURE(design.architecture, design.cores, design.also);
    r.triangle_design(design.architecture, design.cores, true, design.also);
    check_windows(r);
  }
}

TEST_CASE("waveform: the registers of a core are those of the original hardware, cycle by cycle", "[waveform]") {
  const csv_table table(golden + "trace/jobs_dragon_32.csv.gz");
  const csv_table trace(golden + "trace/trace_dragon_32.csv.gz");
  const auto word = [&](std::size_t row, const char* name) { return table.number(row, table.column(name), -any_word, any_word); };

  // As packets: those jobs whose fixed-point words are binary32 numbers.
  std::vector<job_packet> packets;
  std::vector<std::int64_t> ids;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    job_packet p;
    p.job_word = static_cast<std::uint32_t>(word(row, "a") << job_id_bits | word(row, "id"));
    p.address = static_cast<std::uint32_t>(word(row, "addr"));
    const std::array<const char*, 6> names{"t0x", "t0y", "t0z", "t1x", "t1y", "t1z"};
    bool exact = true;
    for (unsigned i = 0; i < 6; ++i) {
      const float t = static_cast<float>(word(row, names[i])) / 65'536;
      exact = exact && static_cast<std::int64_t>(double{t} * 65'536) == word(row, names[i]);
      std::memcpy(&(i < 3 ? p.t0 : p.t1)[i % 3], &t, sizeof t);
    }
    if (!exact) continue;
    packets.push_back(p);
    ids.push_back(word(row, "id"));
  }
  REQUIRE(packets.size() == 120);

  runner r(packets);
  r.design("espe2019_as_built", 1, false);
  // The trace is of the core alone: its words come through the converter unchanged.
  const vcd w = r.waveform("whole", "--pace stepped --set float_to_fixed.flush_small=false --set float_to_fixed.odd_exponent_lsb=false");
  const auto accepted = w.transfers("rtu.core_job_0");
  REQUIRE(accepted.size() == packets.size());
  std::size_t job = 0;
  std::uint64_t checked = 0;
  for (std::size_t row = 0; row < trace.rows(); ++row) {
    const auto field = [&](const char* name) { return trace.number(row, trace.column(name), -any_word, any_word); };
    while (job < ids.size() && ids[job] < field("id")) ++job;
    if (job == ids.size() || ids[job] != field("id")) continue;
    const auto k = static_cast<std::uint64_t>(field("k"));
    const bool behind_left_out = job != 0 && ids[job - 1] + 1 != ids[job];
    if (behind_left_out && k < 2) continue;  // it begins with what the job before left behind
    const std::uint64_t c = accepted[job] + k;
    CAPTURE(ids[job], k, c);
    REQUIRE(svo_state_words[w.value(c, "rtu.core_0.state")] == trace.field(row, trace.column("state")));
    REQUIRE(w.value(c, "rtu.core_0.job_word") == packets[k == 0 && job != 0 ? job - 1 : job].job_word * (k + job != 0));
    for (const char* name : {"cost", "entry_idx", "mem_addr", "mem_data", "cur_child_idx", "stack_idx"}) {
      CAPTURE(name);
      REQUIRE(w.value(c, std::string("rtu.core_0.") + name) == static_cast<std::uint64_t>(field(name)));
    }
    for (const char* name : {"t0x", "t0y", "t0z", "tmx", "tmy", "tmz", "t1x", "t1y", "t1z"}) {
      CAPTURE(name);
      REQUIRE(w.width(std::string("rtu.core_0.") + name) == 32);
      REQUIRE(w.signed_value(c, std::string("rtu.core_0.") + name) == field(name));
    }
    ++checked;
  }
  CHECK(checked > 4'000);
}

TEST_CASE("waveform: its channels and results are those of the statistics and of the log", "[waveform]") {
  runner r;
  for (const auto& [architecture, cores] : designs) {
    CAPTURE(architecture, cores);
    r.design(architecture, cores, true);
    const vcd w = r.whole();
    check_channels(w, r.statistics("whole"));

    const csv_table log(r.path("whole.csv"));
    const auto left = w.transfers("result");
    REQUIRE(left.size() == log.rows());
    for (std::size_t row = 0; row < log.rows(); ++row) {
      const auto field = [&](const char* name) { return log.number(row, log.column(name), -any_word, any_word); };
      const std::uint64_t c = left[row];
      CAPTURE(row, c);
      REQUIRE(field("cycle") == static_cast<std::int64_t>(c));
      CHECK(field("job_id") == static_cast<std::int64_t>(w.value(c, "result.job_word")));
      CHECK(field("hit") == static_cast<std::int64_t>(w.value(c, "result.hit")));
      CHECK(field("cost") == static_cast<std::int64_t>(w.value(c, "result.cost")));
      CHECK(field("raw_t_hit") == w.signed_value(c, "result.t_hit"));
      CHECK(field("raw_normal_axis") == w.signed_value(c, "result.normal_axis"));
      // A core's states between the edges that take its job and give its result: as many as the ray's cost, then OUT.
      constexpr auto idle_state = static_cast<std::uint64_t>(svo_state::idle), out_state = static_cast<std::uint64_t>(svo_state::out);
      const std::string core = fmt::format("rtu.core_{}", field("core"));
      std::uint64_t out = c;
      while (w.value(out, core + ".job_word") != w.value(c, "result.job_word") || w.value(out, core + ".state") != out_state) --out;
      while (w.value(out - 1, core + ".state") == out_state) --out;
      for (std::uint64_t back = 1; back <= w.value(c, "result.cost"); ++back) {
        const std::uint64_t state = w.value(out - back, core + ".state");
        CHECK((state != idle_state && state != out_state));
      }
      CHECK(w.transfers(out - w.value(c, "result.cost") - 1, fmt::format("rtu.core_job_{}", field("core"))));
    }
  }
}

TEST_CASE("waveform: the channels and results of triangle cores are those of the statistics and of the log", "[waveform]") {
  runner r(teapot_jobs());
  const std::vector<std::uint32_t> faces = load_triangles(teapot, {}, 8, 10, teapot_quads).faces;
  struct row {
    const char* architecture;
    unsigned cores;
  };
  for (const auto& [architecture, cores] : {row{"hanika2007_as_built", 1}, row{"hanika2007", 4}}) {
    CAPTURE(architecture, cores);
    r.triangle_design(architecture, cores, true, "");
    const vcd w = r.whole();
    check_channels(w, r.statistics("whole"));
    const csv_table log(r.path("whole.csv"));
    const auto left = w.transfers("result");
    REQUIRE(left.size() == log.rows());
    std::int64_t hits = 0;
    for (std::size_t row = 0; row < log.rows(); ++row) {
      const auto field = [&](const char* name) { return log.number(row, log.column(name), -any_word, any_word); };
      const std::uint64_t c = left[row];
      const auto shown = [&](const char* name) { return static_cast<std::int64_t>(w.value(c, std::string("result.") + name)); };
      CAPTURE(row, c);
      REQUIRE(field("cycle") == static_cast<std::int64_t>(c));
      CHECK(field("job_id") == shown("job_word"));
      CHECK(field("hit") == shown("hit"));
      CHECK(field("clocks") == shown("cost"));
      CHECK(field("t") == shown("t_hit"));
      CHECK(field("u") == shown("u"));
      CHECK(field("v") == shown("v"));
      CHECK(field("tri") == (field("hit") != 0 ? std::int64_t{faces.at(static_cast<std::size_t>(shown("triangle")))} : -1));
      hits += field("hit");
      // From its dispatch on the ray has the core for as many cycles as it costs; in the last, and in no other, it is done.
      const std::string core = fmt::format("rtu.core_{}", field("core")), jobs = fmt::format("rtu.core_job_{}", field("core"));
      std::uint64_t dispatched = c;
      while (!w.transfers(dispatched, jobs) || w.value(dispatched, jobs + ".job_word") != w.value(c, "result.job_word")) --dispatched;
      for (std::int64_t clock = 1; clock <= field("clocks"); ++clock) {
        const std::uint64_t at = dispatched + static_cast<std::uint64_t>(clock);
        REQUIRE(w.value(at, core + ".job_word") == w.value(c, "result.job_word"));
        REQUIRE(w.value(at, core + ".done") == (clock == field("clocks") ? 1 : 0));
        REQUIRE((w.value(at, core + ".state") == static_cast<std::uint64_t>(bih_state::aabb)) == (clock == 1));
      }
    }
    CHECK(hits > 20);
  }
}

TEST_CASE("waveform: packets show t values in the design's fixed-point format", "[waveform]") {
  runner r(50);
  r.design("espe2019", 2, false);
  const vcd w = r.waveform("narrow", "--set fixed_point.integer_bits=14 --set fixed_point.fraction_bits=13");
  for (const char* name : {"rtu.pending_job.t0x", "rtu.core_job_1.t1z", "rtu.core_1.tmy", "result.t_hit"}) CHECK(w.width(name) == 27);
  CHECK(w.width("job.t0_float_x") == 32);
}

TEST_CASE("waveform: two runs give the same bytes", "[waveform]") {
  runner r;
  r.design("espe2019", 4, true);
  for (const char* options : {"--pace stepped", "--vcd-from 300 --vcd-to 420"}) {
    r.waveform("one", options);
    r.waveform("two", options);
    CHECK((r.bytes("one.vcd") == r.bytes("two.vcd")));
  }
}

TEST_CASE("waveform: the translate filter names the states", "[waveform]") {
  std::ifstream file(source + "/waveforms/svo_state.filter");
  std::string value, name;
  std::size_t states = 0;
  while (file >> value >> name) {
    REQUIRE(states < std::size(svo_state_words));
    CHECK(value == std::to_string(states));
    CHECK(name == svo_state_words[states]);
    ++states;
  }
  CHECK(states == std::size(svo_state_words));
}

TEST_CASE("waveform: the save file names signals that there are, in their widths", "[waveform]") {
  runner r(20);
  r.design("espe2019", 16, false);
  const vcd w = r.whole();
  std::ifstream file(source + "/waveforms/rtu.gtkw");
  const std::string top = "SystemC.";
  std::string line;
  unsigned named = 0;
  while (std::getline(file, line)) {
    if (line.rfind("^1 ", 0) == 0) CHECK(std::filesystem::exists(source + "/" + line.substr(3)));
    const auto begin = line.find(top);
    if (begin == std::string::npos) continue;
    const auto range = line.find('[', begin);
    const std::string name = line.substr(begin + top.size(), range == std::string::npos ? range : range - begin - top.size());
    CAPTURE(line);
    REQUIRE(w.signals().count(name) == 1);
    CHECK((range == std::string::npos ? "" : line.substr(range)) == (w.width(name) == 1 ? "" : fmt::format("[{}:0]", w.width(name) - 1)));
    ++named;
  }
  CHECK(named > 50);
}

}  // namespace rtusim
