#include "modules/config/schema.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "modules/config/error.h"

namespace fs = std::filesystem;
namespace config = rtusim::config;
using nlohmann::ordered_json;
using rtusim::input_error;

namespace {

enum class kind : std::uint8_t { svo, bih, sphere };
enum class policy : std::uint8_t { cyclic_first_available, round_robin, first_available };
enum class valid : std::uint8_t { always, gap };

struct rtu_params {
  kind core = kind::svo;
  unsigned cores = 1;
  double clock_mhz = 100;
  void describe(config::section& s) {
    s.choice("core", core, {"svo", "bih", "sphere"}, "what the cores walk");
    s.number("cores", cores, {1, 1024}, "cores", "how many cores work in parallel");
    s.real("clock_mhz", clock_mhz, {1, 1000}, "MHz", "the clock");
  }
};
struct scheduler_params {
  policy select = policy::cyclic_first_available;
  void describe(config::section& s) {
    s.choice("policy", select, {"cyclic_first_available", "round_robin", "first_available"}, "how a job finds its core");
  }
};
struct svo_core_params {
  bool far_popcount = false, no_push = false;
  std::uint8_t stack = 23;
  void describe(config::section& s) {
    s.erratum("far_popcount", far_popcount, "counts all bits", "counts the bits below");
    s.erratum("no_push", no_push, "never pushes", "pushes");
    s.number("stack", stack, {}, "", "entries of the stack");
  }
};
struct source_params {
  valid when = valid::always;
  std::uint32_t gap_cycles = 1;
  std::uint64_t seed = 0xACE1;
  void describe(config::section& s) {
    s.choice("valid", when, {"always", "gap"}, "when a ray is offered");
    s.number("gap_cycles", gap_cycles, {1, 1000}, "cycles", "the cycles between two rays")
        .when([this] { return when == valid::gap; }, "source.valid = gap");
    s.number("seed", seed, {}, "", "the first state of the random register");
  }
};
struct scene_params {
  std::string model = "dragon.svo";
  void describe(config::section& s) { s.text("model", model, "the model to draw"); }
};
struct camera_params {
  std::array<double, 3> position{0, 0, -2};
  double roll = 0;
  void describe(config::section& s) {
    s.vector("position", position, {}, "m", "where the eye is");
    s.real("roll", roll, {}, "degrees", "the turn about the line of sight");
  }
};

/// A design, its testbench and its scene, and the text of the error an action ends in.
struct bench {
  rtu_params rtu;
  scheduler_params scheduler;
  svo_core_params svo_core;
  source_params source;
  scene_params scene;
  camera_params camera;
  config::schema all;
  fs::path file = fs::temp_directory_path() / fmt::format("rtusim_schema_test-{}.toml", ::getpid());

  bench() {
    all.add("rtu", rtu, "an architecture file");
    all.add("scheduler", scheduler, "an architecture file");
    all.add("svo_core", svo_core, "an architecture file");
    all.add("source", source, "a bench file");
    all.add("scene", scene, "a scene file");
    all.add("camera", camera, "a scene file");
    all.entry_form("rtu.core", {{"kind", "rtu.core"}, {"count", "rtu.cores"}}, "this version builds one kind of core");
  }
  ~bench() { fs::remove(file); }

  void read(const std::string& text, const std::string& kind = "an architecture file") {
    std::ofstream(file, std::ios::binary) << text;
    all.read_toml(file, kind);
  }
};

/// What the action throws, `FILE` put for the file's name.
template <class Action>
std::string error_of(const bench& b, Action&& action) {
  try {
    action();
  } catch (const input_error& e) {
    std::string text = e.what();
    if (const auto at = text.find(b.file.string()); at != std::string::npos) text.replace(at, b.file.string().size(), "FILE");
    return text;
  }
  return "no error";
}

std::string file_error(const std::string& text) {
  bench b;
  return error_of(b, [&] { b.read(text); });
}

std::string set_error(const std::string& text) {
  bench b;
  return error_of(b, [&] { b.all.set(text); });
}

const std::string policies = "cyclic_first_available, round_robin or first_available";

}  // namespace

TEST_CASE("A file sets every kind of parameter") {
  bench b;
  b.read("# a design\n[rtu]\ncore = 'bih'\ncores = 0x10\nclock_mhz = 125\n[scheduler]\npolicy = \"round_robin\"\n");
  CHECK(b.rtu.core == kind::bih);
  CHECK(b.rtu.cores == 16);
  CHECK(b.rtu.clock_mhz == 125.0);
  CHECK(b.scheduler.select == policy::round_robin);
  b.read("scene.model = 'a b.svo'\ncamera.position = [1, 2.5, -3e2]\ncamera.roll = 3\n", "a scene file");
  CHECK(b.scene.model == "a b.svo");
  CHECK(b.camera.position == std::array<double, 3>{1, 2.5, -300});
  CHECK(b.camera.roll == 3.0);
}

TEST_CASE("A file without keys changes nothing") {
  bench b;
  const auto before = b.all.values();
  for (const char* text : {"", "\n# nothing\n", "\xef\xbb\xbf", "[rtu]\n[scheduler]\n", "[errata]\n"}) b.read(text);
  CHECK(b.all.values() == before);
}

TEST_CASE("A later place wins over an earlier one") {
  bench b;
  b.read("rtu.cores = 2\nrtu.clock_mhz = 50\n");
  b.read("rtu.cores = 4\n");
  b.all.set("rtu.cores=8");
  b.all.set("rtu.cores = 0x20");
  CHECK(b.rtu.cores == 32);
  CHECK(b.rtu.clock_mhz == 50.0);
}

TEST_CASE("Errata are set one by one, by alias, or all") {
  const struct {
    const char* text;
    bool far_popcount, no_push;
  } files[] = {
      {"svo_core.far_popcount = true", true, false},
      {"errata.no_push = true", false, true},
      {"errata.all = true", true, true},
      {"errata.all = false", false, false},
      {"[errata]\nno_push = false\nall = true", true, false},
      {"svo_core.no_push = false\nerrata.all = true", true, false},
      {"errata.all = false\nerrata.far_popcount = true", true, false},
  };
  for (const auto& row : files) {
    bench b;
    b.read(row.text);
    CHECK(b.svo_core.far_popcount == row.far_popcount);
    CHECK(b.svo_core.no_push == row.no_push);
  }
  bench b;
  b.all.set("errata.no_push=true");
  b.all.set("errata.all=false");
  CHECK(!b.svo_core.no_push);
  b.all.set("errata.all=true");
  b.all.set("svo_core.no_push=false");
  CHECK(b.svo_core.far_popcount);
  CHECK(!b.svo_core.no_push);
  b.read("errata.all = false\n");
  CHECK(!b.svo_core.far_popcount);
}

TEST_CASE("One [[rtu.core]] entry is the long form of rtu.core and rtu.cores") {
  for (const char* text : {"[[rtu.core]]\nkind = \"bih\"\ncount = 16\n", "[rtu]\ncore = [{count = 16, kind = 'bih'}]\n"}) {
    bench b;
    b.read(text);
    CHECK(b.rtu.core == kind::bih);
    CHECK(b.rtu.cores == 16);
  }
  bench b;
  b.read("[[rtu.core]]\ncount = 3\n[rtu]\n");
  CHECK(b.rtu.core == kind::svo);
  CHECK(b.rtu.cores == 3);
  b.all.set("rtu.core=[{kind='sphere'}]");
  CHECK(b.rtu.core == kind::sphere);
}

TEST_CASE("A file's errors say where, what was found, and what was expected") {
  const std::string cores = "expected a whole number from 1 to 1024 cores";
  const std::string one = ", but this version builds one kind of core; expected one [[rtu.core]] entry";
  const struct {
    std::string text, message;
  } table[] = {
      {"rtu.cores = 0", "FILE:1: rtu.cores = 0; " + cores},
      {"[rtu]\n\ncores = 1025", "FILE:3: rtu.cores = 1025; " + cores},
      {"rtu.cores = -1", "FILE:1: rtu.cores = -1; " + cores},
      {"rtu.cores = 1.0", "FILE:1: rtu.cores = 1.0; " + cores},
      {"rtu.cores = '1'", "FILE:1: rtu.cores = \"1\"; " + cores},
      {"rtu.cores = true", "FILE:1: rtu.cores = true; " + cores},
      {"rtu.cores = [1]", "FILE:1: rtu.cores = [1]; " + cores},
      {"rtu.cores = {}", "FILE:1: rtu.cores = {}; " + cores},
      {"rtu.cores = 2001-02-03", "FILE:1: rtu.cores = 2001-02-03; " + cores},
      {"rtu.cores = [[1, 2], {a = 1}, {}, 4]", "FILE:1: rtu.cores = [[...], {...}, {}, ...]; " + cores},
      {"svo_core.stack = 256", "FILE:1: svo_core.stack = 256; expected a whole number from 0 to 255"},
      {"rtu.clock_mhz = nan", "FILE:1: rtu.clock_mhz = nan; expected a finite number from 1 to 1000 MHz"},
      {"rtu.clock_mhz = -inf", "FILE:1: rtu.clock_mhz = -inf; expected a finite number from 1 to 1000 MHz"},
      {"rtu.clock_mhz = 0.5", "FILE:1: rtu.clock_mhz = 0.5; expected a finite number from 1 to 1000 MHz"},
      {"rtu.clock_mhz = 'fast'", "FILE:1: rtu.clock_mhz = \"fast\"; expected a finite number from 1 to 1000 MHz"},
      {"errata.no_push = 1", "FILE:1: errata.no_push = 1; expected true or false"},
      {"errata.all = 'yes'", "FILE:1: errata.all = \"yes\"; expected true or false"},
      {"scheduler.policy = 'fifo'", "FILE:1: scheduler.policy = \"fifo\"; expected " + policies},
      {"scheduler.policy = 'round_robbin'",
       "FILE:1: scheduler.policy = \"round_robbin\"; expected " + policies + "; did you mean round_robin?"},
      {"scheduler.policy = 1", "FILE:1: scheduler.policy = 1; expected " + policies},
      {"scheduler.policy = '''a\nb'''", "FILE:1: scheduler.policy = \"a\\nb\"; expected " + policies},
      {"scheduler.policy = '" + std::string(500, 'x') + "'",
       "FILE:1: scheduler.policy = \"" + std::string(59, 'x') + "...; expected " + policies},
      {"\n[scheduler]\npolcy = 'fifo'", "FILE:3: unknown key scheduler.polcy; expected scheduler.policy"},
      {"errata.far_popcnt = true", "FILE:1: unknown key errata.far_popcnt; expected errata.far_popcount"},
      {"errata.al = true", "FILE:1: unknown key errata.al; expected errata.all"},
      {"whatever = 1", "FILE:1: unknown key whatever; expected one of the keys that 'rtusim explain' lists"},
      {"[schedler]", "FILE:1: unknown key schedler; expected scheduler"},
      {"scheduler = 3", "FILE:1: scheduler = 3; expected keys of the section [scheduler]"},
      {"[[scheduler]]\npolicy = 'x'", "FILE:1: scheduler = [{...}]; expected keys of the section [scheduler]"},
      {"rtu.cores.each = 1", "FILE:1: unknown key rtu.cores.each; expected one of the keys that 'rtusim explain' lists"},
      {"[scheduler.policy]\nx.y.z.deep = 1", "FILE:2: unknown key scheduler.policy.x; expected scheduler.policy"},
      {"\"rtu.cores\" = 1", "FILE:1: unknown key \"rtu.cores\"; expected rtu.cores"},
      {"rtu.\"co\\nres\" = 1", "FILE:1: unknown key rtu.\"co\\nres\"; expected rtu.cores"},
      {"camera.position = [0, 0, 0]",
       "FILE:1: camera.position belongs in a scene file; expected keys of errata, rtu, scheduler or svo_core"},
      {"[camera]", "FILE:1: camera belongs in a scene file; expected keys of errata, rtu, scheduler or svo_core"},
      {"source.sed = 1", "FILE:1: source.sed belongs in a bench file; expected keys of errata, rtu, scheduler or svo_core"},
      {"rtu.cores = 0\nrtu.clock_mhz = 0", "FILE:1: rtu.cores = 0; " + cores},
      {"rtu.clock_mhz = 0\nrtu.cores = 0", "FILE:1: rtu.clock_mhz = 0; expected a finite number from 1 to 1000 MHz"},
      {"errata.no_push = true\nsvo_core.no_push = true", "FILE:2: svo_core.no_push was given before, at FILE:1; expected it once"},
      {"[[rtu.core]]\ncount = 1\n[[rtu.core]]\ncount = 2", "FILE:1: 2 entries [[rtu.core]]" + one},
      {"rtu.core = []", "FILE:1: 0 entries [[rtu.core]]" + one},
      {"rtu.core = ['svo']", "FILE:1: rtu.core = [\"svo\"]; expected one [[rtu.core]] entry"},
      {"[[rtu.core]]\nkind = 'svo'\ncout = 2", "FILE:3: unknown key rtu.core.cout; expected rtu.core.count"},
      {"[[rtu.core]]\nkind = 'svo'\ncount = 0", "FILE:3: rtu.core.count = 0; " + cores},
      {"[[rtu.core]]\nkind = 'sov'", "FILE:2: rtu.core.kind = \"sov\"; expected svo, bih or sphere; did you mean svo?"},
      {"[[rtu.core]]\ncount = 1\n[rtu]\ncores = 2", "FILE:4: rtu.cores was given before, at FILE:2; expected it once"},
  };
  for (const auto& row : table) {
    auto message = row.message;
    const bench name;
    for (auto at = message.find("at FILE"); at != std::string::npos; at = message.find("at FILE"))
      message.replace(at + 3, 4, name.file.string());
    CHECK(file_error(row.text) == message);
  }
  bench b;
  CHECK(error_of(b, [&] { b.read("errata.all = true", "a scene file"); }) ==
        "FILE:1: errata.all belongs in an architecture file; expected keys of camera or scene");
  CHECK(error_of(b, [&] { b.read("errata.no_push = true", "a scene file"); }) ==
        "FILE:1: errata.no_push belongs in an architecture file; expected keys of camera or scene");
  for (const char* value : {"[1, 2]", "[1, 2, 3, 4]", "[1, 2, nan]", "[1, 2, 'x']", "1", "[[1], 2, 3]"})
    CHECK_THAT(error_of(b, [&] { b.read(fmt::format("camera.position = {}", value), "a scene file"); }),
               Catch::EndsWith("; expected an array of three finite numbers of m"));
  CHECK(error_of(b, [&] { b.read("scene.model = 1", "a scene file"); }) == "FILE:1: scene.model = 1; expected a text in quotes");
  CHECK(error_of(b, [&] { b.read("scene.model = \"a\\u0000\"", "a scene file"); }) ==
        "FILE:1: scene.model = \"a\\u0000\"; expected a text in quotes");
  config::schema empty;
  CHECK(error_of(b, [&] { empty.read_toml(b.file, {}); }) ==
        "FILE:1: unknown key scene.model; expected one of the keys that 'rtusim explain' lists");
}

TEST_CASE("What is not TOML, or too much of it, is refused and nothing worse") {
  const auto repeated = [](const std::string& text, unsigned n) {
    std::string all;
    for (unsigned i = 0; i < n; ++i) all += text;
    return all;
  };
  using std::string;
  const std::vector<string> texts = {
      "rtu.cores = ",
      "rtu.cores",
      "[rtu",
      "rtu.cores = 1\nrtu.cores = 2",
      "scheduler.policy = round_robin",
      "rtu.cores = 99999999999999999999",
      "rtu.clock_mhz = i\n",
      "\xff\xfe",
      "scene.model = '\xc3'",
      "\x7f"
      "ELF\x02\x01",
      "rtu.cores = " + repeated("[", 100'000),
      "rtu.cores = " + repeated("{a=", 100'000),
  };
  for (const auto& text : texts) {
    const auto message = file_error(text);
    CHECK_THAT(message, Catch::Matches("FILE:[0-9]+:[0-9]+: .*; expected valid TOML"));
    CHECK(message.find('\n') == std::string::npos);
  }
  CHECK_THAT(file_error("\n\nrtu.cores = ]"), Catch::StartsWith("FILE:3:13: "));
  for (const auto& binary : {string("\0", 1), string("rtu.cores = 1\0", 14), string("glTF\2\0\0\0", 8)})
    CHECK(file_error(binary) == "FILE: a binary file; expected a TOML file");
  const std::string dots = ": a key with too many dots; expected SECTION.FIELD";
  CHECK(file_error(repeated("a.", 400'000) + "a = 1") == "FILE:1" + dots);
  CHECK(file_error("\n[" + repeated("a.", 400'000) + "a]") == "FILE:2" + dots);
  CHECK(file_error("x = {y = \"\"\"\na\"\"\"\", " + repeated("'a'.", 20) + "a = 1}") == "FILE:2" + dots);
  CHECK(file_error("x = '\\' # '.\n" + repeated("a.", 20) + "a = 1") == "FILE:2" + dots);
  const std::string far = "; expected one of the keys that 'rtusim explain' lists";
  CHECK(file_error("x = [" + repeated("0.5, ", 50) + "]") == "FILE:1: unknown key x" + far);
  CHECK(file_error("x = '" + repeated("../", 50) + "' # " + repeated("..", 50)) == "FILE:1: unknown key x" + far);
  CHECK(file_error("x = \"\\\"" + repeated("../", 50) + "\"") == "FILE:1: unknown key x" + far);
  CHECK(file_error(std::string(5000, 'k') + " = 1") == "FILE:1: unknown key \"" + std::string(59, 'k') + "..." + far);
  CHECK_THAT(file_error("x = \xc3\xa9"), Catch::EndsWith("expected valid TOML"));
  CHECK_THAT(file_error("\xc3\xa9 = 1"), Catch::EndsWith("expected valid TOML"));
  CHECK(file_error("x = \"\"\"\\\n \xc3\xa9\"\"\"") == "FILE:1: unknown key x" + far);
  CHECK(file_error("x = 1979-05-27T:") == "FILE: malformed value; expected valid TOML");
  CHECK(file_error(std::string((1 << 20) + 1, '\n')) == "FILE: more than 1048576 bytes; expected a smaller file");
  CHECK(file_error(std::string(1 << 20, '\n')) == "no error");

  bench b;
  CHECK(error_of(b, [&] { b.all.read_toml("/none/a.toml", {}); }) == "/none/a.toml: no such file; expected a file that can be read");
  CHECK(error_of(b, [&] { b.all.read_toml("/", {}); }) == "/: a folder; expected a file");
}

TEST_CASE("set takes TOML, or a bare word") {
  bench b;
  const char* assignments[] = {"rtu.cores=0xAC",    "scheduler.policy=first_available", " rtu.core = \"bih\" ",
                               "rtu.clock_mhz=5e1", "camera.position=[1,2,3]",          "errata.no_push=true",
                               "source.seed=0xACE1"};
  for (const char* text : assignments) b.all.set(text);
  CHECK(b.rtu.cores == 0xAC);
  CHECK(b.scheduler.select == policy::first_available);
  CHECK(b.rtu.core == kind::bih);
  CHECK(b.rtu.clock_mhz == 50.0);
  CHECK(b.camera.position == std::array<double, 3>{1, 2, 3});
  CHECK(b.svo_core.no_push);
  CHECK(b.source.seed == 0xACE1);

  const struct {
    const char* given;
    const char* text;
  } texts[] = {
      {"a.svo", "a.svo"},
      {"'a b'", "a b"},
      {"a b # c.svo", "a b # c.svo"},
      {"7", "7"},
      {"0x10", "0x10"},
      {"true", "true"},
      {"1.50", "1.50"},
      {"2001-02-03", "2001-02-03"},
      {"[1]", "[1]"},
      {"{a = 1}", "{a = 1}"},
      {"a=b", "a=b"},
      {"", ""},
      {"\"\"", ""},
      {"1\nx = 2", "1\nx = 2"},
      {"../../a.svo", "../../a.svo"},
      {"'a", "'a"},
  };
  for (const auto& row : texts) {
    b.all.set(fmt::format("scene.model={}", row.given));
    CHECK(b.scene.model == row.text);
  }
}

TEST_CASE("set refuses in the same words") {
  const std::string cores = "; expected a whole number from 1 to 1024 cores";
  const struct {
    std::string text, message;
  } table[] = {
      {"", "\"\"; expected KEY=VALUE"},
      {"rtu.cores", "\"rtu.cores\"; expected KEY=VALUE"},
      {"=3", "\"=3\"; expected KEY=VALUE"},
      {"rtu.cores=", "rtu.cores = \"\"" + cores},
      {"rtu.cores=many", "rtu.cores = \"many\"" + cores},
      {"rtu.cores=0", "rtu.cores = 0" + cores},
      {"rtu.cores=1\nrtu.clock_mhz=2", "rtu.cores = \"1\\nrtu.clock_mhz=2\"" + cores},
      {"rtu.cores=[[[[]]]]", "rtu.cores = [[...]]" + cores},
      {"rtu.coress=1", "unknown key rtu.coress; expected rtu.cores"},
      {"rtu.cores.x=1", "unknown key rtu.cores.x; expected rtu.cores"},
      {"rtu.core s=1", "unknown key \"rtu.core s\"; expected rtu.cores"},
      {"rtu=1", "rtu = 1; expected keys of the section [rtu]"},
      {"errata.all=maybe", "errata.all = \"maybe\"; expected true or false"},
      {"scheduler.policy=first_avialable",
       "scheduler.policy = \"first_avialable\"; expected " + policies + "; did you mean first_available?"},
      {"rtu.core=[]", "0 entries [[rtu.core]], but this version builds one kind of core; expected one [[rtu.core]] entry"},
      {"scene.model=\xff", "scene.model = \"\xef\xbf\xbd\"; expected a text in quotes"},
  };
  for (const auto& row : table) CHECK(set_error(row.text) == "--set: " + row.message);
}

TEST_CASE("check_read refuses a value that this design does not read") {
  bench b;
  b.read("[source]\n\ngap_cycles = 4\n", "a bench file");
  CHECK(error_of(b, [&] { b.all.check_read(); }) ==
        "FILE:3: source.gap_cycles is not read by this design; expected it only when source.valid = gap");
  b.all.set("source.valid=gap");
  b.all.check_read();
  b.all.set("source.gap_cycles=5");
  b.all.set("source.valid=always");
  CHECK(error_of(b, [&] { b.all.check_read(); }) ==
        "--set: source.gap_cycles is not read by this design; expected it only when source.valid = gap");
}

TEST_CASE("set takes back what a file gave") {
  bench b;
  b.read("[rtu]\ncores = 9\ncore = 'bih'\n[svo_core]\nno_push = true\nfar_popcount = true\n");
  b.read("[source]\nvalid = 'gap'\ngap_cycles = 5\n", "a bench file");
  b.read("[scene]\nmodel = 'bunny.svo'\n[camera]\nposition = [1, 2, 3]\n", "a scene file");
  for (const char* text : {"rtu.cores=default", "rtu.core = default", "errata.no_push=default", "source.valid=default",
                           "source.gap_cycles=default", "scene.model=default", "camera.position=default"})
    b.all.set(text);
  b.all.check_read();  // the gap, too, is as if it had not been given
  CHECK(b.svo_core.far_popcount);
  b.all.set("errata.all=default");
  CHECK(b.all.values() == bench().all.values());
  b.all.set("scene.model='default'");
  CHECK(b.scene.model == "default");
  CHECK(set_error("rtu.coers=default") == "--set: unknown key rtu.coers; expected rtu.cores");
  CHECK(set_error("rtu.cores='default'") == "--set: rtu.cores = \"default\"; expected a whole number from 1 to 1024 cores");
}

TEST_CASE("The record of the values holds what is read, and sets it again") {
  bench b;
  CHECK(b.all.values() == ordered_json::parse(R"({
    "rtu": {"core": "svo", "cores": 1, "clock_mhz": 100.0}, "scheduler": {"policy": "cyclic_first_available"},
    "svo_core": {"far_popcount": false, "no_push": false, "stack": 23}, "source": {"valid": "always", "seed": 44257},
    "scene": {"model": "dragon.svo"}, "camera": {"position": [0.0, 0.0, -2.0], "roll": 0.0}})"));
  for (const char* text : {"source.valid=gap", "rtu.cores=7", "errata.all=true", "camera.roll=0.1", "scene.model='\xc3\xa4\"'"})
    b.all.set(text);
  b.source.seed = ~std::uint64_t{0};
  const auto record = b.all.values();
  CHECK(record["source"]["gap_cycles"] == 1);

  bench again;
  again.all.read_json(nlohmann::json::parse(record.dump()), "stats.json");
  again.all.check_read();
  CHECK(again.all.values().dump() == record.dump());

  const struct {
    const char* text;
    std::string message;
  } table[] = {
      {"[]", "[]; expected an object of parameters by section"},
      {R"({"rtu": {"cores": 0}})", "rtu.cores = 0; expected a whole number from 1 to 1024 cores"},
      {R"({"rtu": {"cores": {"a": 1}}})", "rtu.cores = {...}; expected a whole number from 1 to 1024 cores"},
      {R"({"rtu": {"cores": null}})", "rtu.cores = null; expected a whole number from 1 to 1024 cores"},
      {R"({"rtu": {"core": [{"kind": "svo"}]}})", "rtu.core = [{...}]; expected svo, bih or sphere"},
      {R"({"rtu": 3})", "rtu = 3; expected keys of the section [rtu]"},
      {R"({"rtu": {"coress": 1}})", "unknown key rtu.coress; expected rtu.cores"},
      {R"({"rtu.cores": 1})", "unknown key \"rtu.cores\"; expected rtu.cores"},
      {R"({"scene": {"model": 1}})", "scene.model = 1; expected a text in quotes"},
  };
  for (const auto& row : table)
    CHECK(error_of(again, [&] { again.all.read_json(nlohmann::json::parse(row.text), "stats.json"); }) == "stats.json: " + row.message);
}

TEST_CASE("explain lists parameters by prefix, with their defaults") {
  bench b;
  b.all.set("source.gap_cycles=9");
  CHECK(b.all.explain("source") ==
        "key                default  values, meaning, and when it is read\n"
        "source.valid       always   always or gap\n"
        "                            when a ray is offered\n"
        "source.gap_cycles  1        a whole number from 1 to 1000 cycles\n"
        "                            the cycles between two rays\n"
        "                            read only when source.valid = gap\n"
        "source.seed        44257    a whole number of at least 0\n"
        "                            the first state of the random register\n");
  CHECK(b.all.explain("rtu.core") ==
        "key       default  values, meaning, and when it is read\n"
        "rtu.core  svo      svo, bih or sphere\n"
        "                   what the cores walk\n"
        "                   in a file also: one table [[rtu.core]] with count (rtu.cores), kind (rtu.core)\n");
  const std::string erratum =
      "svo_core.no_push  false    true or false\n"
      "                           as built: never pushes; right: pushes\n"
      "                           also: errata.no_push\n";
  const std::string title = "key               default  values, meaning, and when it is read\n";
  CHECK(b.all.explain("svo_core.no_push") == title + erratum);
  CHECK(b.all.explain("errata.no_push") == title + erratum);
  CHECK(b.all.explain("errata.all") ==
        "key         default  values, meaning, and when it is read\n"
        "errata.all           true or false\n"
        "                     sets errata.far_popcount, errata.no_push; one named by itself wins\n");
  CHECK_THAT(b.all.explain("errata"), Catch::Contains("svo_core.far_popcount") && Catch::Contains("\nerrata.all "));
  const auto everything = b.all.explain("");
  for (const auto& s : b.all.sections())
    for (const auto& p : s.parameters()) CHECK_THAT(everything, Catch::Contains(p.key) && Catch::Contains(p.meaning.substr(0, 10)));

  const struct {
    const char* key;
    const char* expected;
  } table[] = {
      {"schduler", "scheduler"},
      {"scheduler.polcy", "scheduler.policy"},
      {"rtu.cor", "rtu.core"},
      {"nothing", "one of the keys that 'rtusim explain' lists"},
  };
  for (const auto& row : table)
    CHECK(error_of(b, [&] { b.all.explain(row.key); }) == fmt::format("explain: unknown key {}; expected {}", row.key, row.expected));
}

TEST_CASE("explain wraps long texts and keeps long defaults apart") {
  struct {
    std::string path = std::string(90, 'p');
    void describe(config::section& s) {
      s.text("path", path, "word word word word word word word word word word word word word word word word word");
    }
  } params;
  config::schema all;
  all.add("file", params);
  CHECK(all.explain("") ==
        "key        default  values, meaning, and when it is read\n"
        "file.path  " +
            std::string(90, 'p') +
            "\n"
            "                    a text in quotes\n"
            "                    word word word word word word word word word word word word word word word word\n"
            "                    word\n");
}

TEST_CASE("nearest takes a word within a third of its length") {
  const std::vector<std::string> words = {"round_robin", "first_available", "abc"};
  const struct {
    const char* word;
    const char* found;
  } table[] = {
      {"round_robin", "round_robin"},
      {"raund-robbin", "round_robin"},
      {"rr", ""},
      {"", ""},
      {"abd", "abc"},
      {"acb", "abc"},
      {"cab", ""},
      {"ab", "abc"},
      {"abcd", "abc"},
  };
  for (const auto& row : table) CHECK(config::nearest(row.word, words) == row.found);
  CHECK(config::nearest(std::string(1'000'000, 'x'), words).empty());
  CHECK(config::nearest("x", {}).empty());
}

TEST_CASE("A key described twice is the program's fault") {
  rtu_params one, two;
  config::schema all;
  all.add("rtu", one);
  CHECK_THROWS_AS(all.add("rtu", two), rtusim::simulation_error);
}
