#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/files.h"
#include "modules/formats/packets.h"
#include "modules/svo_core/svo_params.h"
#include "testbench/csv.h"
#include "testbench/job_file.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

const std::string source = RTUSIM_SOURCE_DIR;
const std::string golden = source + "/testbench/golden/svo/";
constexpr std::uint64_t period_ps = 10'000;
constexpr std::int64_t any_word = std::int64_t{1} << 40;

/// A VCD file by cycle. Values change as a cycle begins; the clock falls in its middle.
class vcd {
 public:
  explicit vcd(const std::filesystem::path& file) {
    std::istringstream in(config::read_file(file));
    read_declarations(in);
    read_values(in);
  }

  std::uint64_t first() const { return first_; }
  std::uint64_t cycles() const { return values_.size(); }
  std::uint64_t end() const { return first_ + cycles(); }
  const std::map<std::string, std::size_t>& signals() const { return signals_; }
  /// The values of a cycle in the order of the signals' declaration.
  const std::vector<std::uint64_t>& at(std::uint64_t cycle) const { return values_.at(cycle - first_); }
  std::uint64_t value(std::uint64_t cycle, const std::string& name) const { return at(cycle).at(signals_.at(name)); }
  std::int64_t signed_value(std::uint64_t cycle, const std::string& name) const {
    const unsigned up = 64 - width(name);
    return static_cast<std::int64_t>(value(cycle, name) << up) >> up;
  }
  unsigned width(const std::string& name) const { return widths_.at(signals_.at(name)); }
  bool transfers(std::uint64_t cycle, const std::string& channel) const {
    return value(cycle, channel + ".valid") != 0 && value(cycle, channel + ".ready") != 0;
  }
  /// The cycles in which a channel transfers.
  std::vector<std::uint64_t> transfers(const std::string& channel) const {
    std::vector<std::uint64_t> found;
    for (std::uint64_t c = first(); c < end(); ++c)
      if (transfers(c, channel)) found.push_back(c);
    return found;
  }

 private:
  void read_declarations(std::istream& in) {
    std::vector<std::string> scopes;
    std::string word, kind, code, name;
    while (in >> word && word != "$enddefinitions") {
      if (word == "$timescale") {
        std::string number, unit;
        in >> number >> unit;
        REQUIRE(number + unit == "1ps");
      } else if (word == "$scope") {
        in >> kind >> name;
        scopes.push_back(name);
      } else if (word == "$upscope") {
        scopes.pop_back();
      } else if (word == "$var") {
        unsigned width = 0;
        in >> kind >> width >> code >> name;
        std::string path;
        for (std::size_t i = 1; i < scopes.size(); ++i) path += scopes[i] + '.';  // the first is SystemC itself
        REQUIRE(signals_.emplace(path + name, widths_.size()).second);
        codes_.emplace(code, widths_.size());
        widths_.push_back(width);
      }
    }
    REQUIRE(scopes.empty());
  }

  void read_values(std::istream& in) {
    std::vector<std::uint64_t> now(widths_.size());
    const std::size_t clock = signals_.at("clock");
    std::uint64_t time = 0;
    bool started = false;
    std::string line;
    const auto require = [&line, &time](bool holds, const char* what) {
      if (!holds) FAIL(what << ": " << line << " at " << time);
    };
    while (std::getline(in, line)) {
      if (line.empty() || line[0] == '$' || line[0] == ' ') continue;
      if (line[0] == '#') {
        const std::uint64_t stamp = std::stoull(line.substr(1));
        require(stamp % (period_ps / 2) == 0, "time within a half period");
        if (!started) first_ = stamp / period_ps;
        started = true;
        for (; time / period_ps < stamp / period_ps; time = (time / period_ps + 1) * period_ps)
          if (time / period_ps >= first_) values_.push_back(now);
        time = stamp;
        continue;
      }
      const bool scalar = line[0] != 'b';
      const auto space = line.find(' ');
      const std::string_view bits = std::string_view(line).substr(scalar ? 0 : 1, scalar ? 1 : space - 1);
      const std::size_t signal = codes_.at(line.substr(scalar ? 1 : space + 1));
      require(started, "value without a time");
      require(bits.find_first_not_of("01") == std::string_view::npos, "unknown bits");
      require(bits.size() <= widths_[signal], "wider than declared");
      std::uint64_t value = 0;
      for (const char bit : bits) value = value << 1 | (bit == '1');
      require((signal == clock ? value : 1) == (time % period_ps == 0), "not at the clock's edge");
      now[signal] = signal == clock ? 1 : value;
    }
    REQUIRE(time % period_ps == 0);
  }

  std::map<std::string, std::size_t> signals_;
  std::map<std::string, std::size_t> codes_;
  std::vector<unsigned> widths_;
  std::uint64_t first_ = 0;
  std::vector<std::vector<std::uint64_t>> values_;
};

/// Runs `rtusim run` on jobs of the dragon.
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

struct design_point { const char* architecture; unsigned cores; };
constexpr design_point designs[] = {{"espe2019_as_built", 1}, {"espe2019_as_built", 4}, {"espe2019_as_built", 16},
                                    {"espe2019", 1},          {"espe2019", 4},          {"espe2019", 16}};

/// Every signal of the window has the value that it has in the recording of the whole run, from the first to the last.
void check_within(const vcd& window, const vcd& whole) {
  REQUIRE(window.signals() == whole.signals());
  REQUIRE(window.end() <= whole.end());
  for (std::uint64_t c = window.first(); c < window.end(); ++c) {
    if (window.at(c) == whole.at(c)) continue;
    for (const auto& [name, signal] : window.signals()) {
      CAPTURE(c, name);
      REQUIRE(window.at(c)[signal] == whole.at(c)[signal]);
    }
  }
}

}  // namespace

TEST_CASE("waveform: a window of cycles or of a job shows what a recording of the whole run shows, and changes nothing", "[waveform]") {
  runner r;
  for (const auto& [architecture, cores] : designs) {
    CAPTURE(architecture, cores);
    r.design(architecture, cores, true);
    const vcd whole = r.whole();
    REQUIRE(whole.first() == 0);
    REQUIRE(whole.end() == r.statistics("whole")["statistics"]["total_cycles"].get<std::uint64_t>() + 1);
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
}

TEST_CASE("waveform: the registers of a core are those of the original hardware, clock by clock", "[waveform]") {
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
    const auto statistics = r.statistics("whole");
    for (const auto& [name, figures] : statistics["statistics"]["channels"].items()) {
      CAPTURE(name);
      const std::string path = w.signals().count(name + ".valid") != 0 ? name : "rtu." + name;
      std::map<std::string, std::uint64_t> counted;
      for (std::uint64_t c = 0; c < w.end(); ++c) {
        REQUIRE(w.value(c, path + ".transfers") == counted["transferred"]);
        const bool valid = w.value(c, path + ".valid") != 0, ready = w.value(c, path + ".ready") != 0;
        ++counted[valid && ready ? "transferred" : ready ? "starved" : valid ? "held_back" : "idle"];
      }
      for (const char* kind : {"transferred", "starved", "held_back", "idle"}) {
        CAPTURE(kind);
        CHECK(figures[kind] == counted[kind]);
      }
    }

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
