#include "modules/formats/bih_memory.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

const std::string scenes = RTUSIM_SOURCE_DIR "/testbench/golden/bih/scenes/";

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const input_error& e) {
    return e.what();
  }
  return "accepted";
}

std::string refusal(const bih_memory& memory, const bih_rules& rules = {}) {
  return refusal([&] { check_bih(memory, "m", rules); });
}

void put(bih_memory& memory, std::uint32_t node, const bih_words& words) {
  for (unsigned w = 0; w < 3; ++w) memory.words[w][node] = words[w];
}

/// Node 0 over the leaves 1 and 2, of a triangle each.
bih_memory smallest() {
  bih_memory memory(6);
  memory.corner = {7, 7, 7};
  memory.triangles.resize(2);
  put(memory, 0, make_inner(1, 1, 4, 4));
  put(memory, 1, make_leaf(0, 1));
  put(memory, 2, make_leaf(1, 1));
  memory.words[3][1] = 1;
  return memory;
}

/// `levels` inner nodes, each with a leaf and the next.
bih_memory ladder(unsigned levels) {
  bih_memory memory(10);
  memory.triangles.resize(1);
  std::uint32_t node = 0;
  for (std::uint32_t i = 0; i < levels; ++i) {
    put(memory, node, make_inner(i % 3, 2 * i + 1, 0, 0));
    put(memory, 2 * i + 2, make_leaf(0, 1));
    node = 2 * i + 1;
  }
  put(memory, node, make_leaf(0, 1));
  return memory;
}

}  // namespace

TEST_CASE("a stack entry's fields", "[bih_memory]") {
  STATIC_REQUIRE(pack({3, 0, 0})[3] == std::uint64_t{3} << 26);
  STATIC_REQUIRE(pack({0, 1, 2})[0] == 1);
  STATIC_REQUIRE(pack({0, 1, 2})[1] == std::uint64_t{2} << 31);
  STATIC_REQUIRE(pack({0, 0, 64})[2] == 2);
  STATIC_REQUIRE(pack({1 << 10, 0, 0})[3] == std::uint64_t{1} << 22);
  STATIC_REQUIRE(pack({1 << 14, 0, 0})[1] == std::uint64_t{1} << 27);
  STATIC_REQUIRE(pack({0, -1, -1})[0] == greatest_bih_word);
  STATIC_REQUIRE(pack({0, -1, -1})[1] == 0xf87ffffff);
  STATIC_REQUIRE(pack({0, -1, -1})[3] == 0x3fffff);
  test::rng random(3);
  for (int i = 0; i < 10'000; ++i) {
    const auto word = [&] { return static_cast<std::int64_t>(std::uint64_t{random()} << 32 | random()); };
    const bih_stack_entry e{random() & 0x3ffff, word() >> (1 + random() % 62), word() >> (1 + random() % 62)};
    const bih_words words = pack(e);
    for (const std::uint64_t w : words) REQUIRE(w <= greatest_bih_word);
    const bih_stack_entry back = unpack(words);
    REQUIRE(back.far == e.far);
    REQUIRE(back.tmin == e.tmin);
    REQUIRE(back.tmax == e.tmax);
    // All words mean something: what was never pushed can be kept as an entry, too.
    const bih_words raw{word() & greatest_bih_word, word() & greatest_bih_word, word() & greatest_bih_word, word() & greatest_bih_word};
    REQUIRE(pack(unpack(raw)) == raw);
  }
}

TEST_CASE("the golden memories are read, checked and written back", "[bih_memory]") {
  struct row {
    const char* name;
    std::uint64_t inner, listed, levels;
  };
  const row table[] = {{"tetra_k1", 3, 4, 4}, {"cube_k2", 0, 12, 0}, {"cubepot_k4", 0, 564, 0}, {"cubepot_k8", 0, 564, 0}};
  for (const row& r : table) {
    CAPTURE(r.name);
    const bih_memory memory = read_bih(scenes + r.name, 10);
    CHECK(memory.triangles.size() == 1024);
    const bih_summary summary = check_bih(memory, r.name);
    CHECK(summary.leaves == summary.inner_nodes + 1);
    CHECK(summary.listed == r.listed);
    if (r.inner != 0) CHECK(summary.inner_nodes == r.inner);
    if (r.levels != 0) CHECK(summary.levels == r.levels);
    CHECK(summary.stack_entries < summary.levels);

    test::scratch_folder folder;
    write_bih(folder / "new", memory);
    for (const std::string file : {"bih0", "bih1", "bih2", "bih3", "tri_ram"})
      CHECK((config::read_file(folder / ("new/" + file + ".txt")) == config::read_file(scenes + r.name + "/" + file + ".txt.gz")));
    CHECK(config::read_file(folder / "new/scene_aabb.txt") == config::read_file(scenes + r.name + "/scene_aabb.txt"));
    CHECK((read_bih(folder / "new", 10).words == memory.words));
  }
  const bih_memory tetra = read_bih(scenes + "tetra_k1", 10);
  CHECK(tetra.corner == per_axis<std::int64_t>{0x3fffffff, 0x3fffffff, 0x3fffffff});
  CHECK(tetra.triangles[0].nq == -0x7e95ec33);
}

TEST_CASE("memories that can't be read name file and line", "[bih_memory]") {
  struct row {
    const char* name;
    const char* file;
    std::function<void(std::string&)> damage;
    const char* message;
  };
  const auto line = [](std::string& text, std::size_t number, const std::string& with) {
    std::size_t at = 0;
    for (std::size_t i = 1; i < number; ++i) at = text.find('\n', at) + 1;
    text.replace(at, text.find('\n', at) - at, with);
  };
  const row table[] = {
      {"empty", "bih0", [](std::string& t) { t.clear(); }, "bih0.txt: 0 lines; expected 64"},
      {"too short", "bih1", [](std::string& t) { t.resize(t.size() - 10); }, "bih1.txt: 63 lines; expected 64"},
      {"too long", "bih3", [](std::string& t) { t += "000000000\n"; }, "bih3.txt: 65 lines; expected 64"},
      {"no number", "bih2", [&](std::string& t) { line(t, 5, "00000000g"); }, "bih2.txt:5: \"00000000g\"; expected a hexadecimal number"},
      {"a sign", "bih2", [&](std::string& t) { line(t, 5, "-00000001"); }, "bih2.txt:5: \"-00000001\"; expected a hexadecimal number"},
      {"two words", "bih2", [&](std::string& t) { line(t, 6, "1 2"); }, "bih2.txt:6: 2 words; expected one"},
      {"no word", "bih2", [&](std::string& t) { line(t, 6, ""); }, "bih2.txt:6: 0 words; expected one"},
      {"37 bits", "bih0", [&](std::string& t) { line(t, 64, "1000000000"); }, "bih0.txt:64: \"1000000000\"; expected a word of 36 bits"},
      {"80 bits", "bih0", [&](std::string& t) { line(t, 1, "11111111112222222222"); }, "expected a word of 36 bits"},
      {"a corner too wide", "scene_aabb", [&](std::string& t) { line(t, 2, "40000000"); },
       "scene_aabb.txt:2: corner = 40000000; expected 30 b"},
      {"no z", "scene_aabb", [](std::string& t) { t.resize(18); }, "scene_aabb.txt: 2 lines; expected 3"},
      {"a field less", "tri_ram", [&](std::string& t) { line(t, 2, "0 0 0 0 0 0 0 0 0"); }, "tri_ram.txt:2: 9 words; expected 10"},
      {"a field more", "tri_ram", [&](std::string& t) { line(t, 2, "0 0 0 0 0 0 0 0 0 0 0"); }, "tri_ram.txt:2: 11 words; expected 10"},
      {"pp below 0", "tri_ram", [&](std::string& t) { line(t, 2, "fffffffff 0 0 0 0 0 0 0 0 0"); },
       "tri_ram.txt:2: pp = fffffffff; expected 30"},
      {"d too wide", "tri_ram", [&](std::string& t) { line(t, 1, "0 0 100000000 0 0 0 0 0 0 0"); },
       "tri_ram.txt:1: d = 100000000; expected 33"},
      {"np too wide", "tri_ram", [&](std::string& t) { line(t, 1, "0 0 0 0 0 0 0 080000000 0 0"); }, ":1: np = 080000000; expected 32"},
      {"r too wide", "tri_ram", [&](std::string& t) { line(t, 1, "0 0 0 0 0 0 0 0 0 4"); }, "tri_ram.txt:1: r = 4; expected 2 bits"},
  };
  for (const row& r : table) {
    CAPTURE(r.name);
    test::scratch_folder folder;
    write_bih(folder / "m", smallest());
    const std::string file = std::string("m/") + r.file + ".txt";
    std::string text = config::read_file(folder / file);
    r.damage(text);
    folder.file(file, text);
    CHECK_THAT(refusal([&] { read_bih(folder / "m", 6); }), Catch::Contains(r.message));
  }
  test::scratch_folder folder;
  CHECK_THAT(refusal([&] { read_bih(folder / "none", 6); }), Catch::Contains("none: no such folder"));
  CHECK_THAT(refusal([&] { read_bih(folder.file("file", ""), 6); }), Catch::Contains("file: a file; expected a folder"));
  write_bih(folder / "m", smallest());
  CHECK_THAT(refusal([&] { read_bih(folder / "m", 10); }), Catch::Contains("64 lines; expected 1024"));
  std::filesystem::remove(folder / "m/tri_ram.txt");
  CHECK(read_bih(folder / "m", 6).triangles.empty());
  std::filesystem::remove(folder / "m/bih3.txt");
  CHECK_THAT(refusal([&] { read_bih(folder / "m", 6); }), Catch::Contains("bih3.txt: no such file"));
}

TEST_CASE("hierarchies that are refused, and which of them as raw words", "[bih_memory]") {
  struct row {
    const char* name;
    std::function<void(bih_memory&)> damage;
    const char* message;
    const char* raw;
  };
  const row table[] = {
      {"nothing", [](bih_memory&) {}, "accepted", "accepted"},
      {"children in the stack", [](bih_memory& m) { put(m, 2, make_inner(0, 31, 0, 0)); },
       "m: node 2 (from the root: 0 2): its children are nodes 31 and 32; expected nodes below 32", "nodes 31 and 32"},
      {"children outside", [](bih_memory& m) { put(m, 2, make_inner(0, 64 + 3, 0, 0)); }, "its children are nodes 67 and 68",
       "its child, node 0, is"},
      {"itself", [](bih_memory& m) { put(m, 0, make_inner(0, 0, 0, 0)); }, "m: node 0 (from the root: 0): its child, node 0, is",
       "its child, node 0, is"},
      {"the root", [](bih_memory& m) { put(m, 2, make_inner(0, 0, 0, 0)); }, "m: node 2 (from the root: 0 2): its child, node 0, is the",
       "its child, node 0, is"},
      {"a shared leaf",
       [](bih_memory& m) {
         put(m, 3, make_leaf(0, 1)), put(m, 2, make_inner(0, 3, 0, 0)), put(m, 4, make_leaf(0, 1)), put(m, 1, make_inner(0, 3, 0, 0));
       },
       "accepted", "accepted"},
      {"an empty leaf", [](bih_memory& m) { put(m, 1, make_leaf(0, 0)); },
       "m: node 1 (from the root: 0 1): a leaf of 0 triangles; expected at least 1", "a leaf of 0 triangles"},
      {"a list into the stack", [](bih_memory& m) { put(m, 1, make_leaf(31, 2)); },
       "its list has the words 31 to 32; expected words below 32", "accepted"},
      {"a list outside", [](bih_memory& m) { put(m, 1, make_leaf(64, 1)); }, "its list has the words 64 to 64", "accepted"},
      {"a long list", [](bih_memory& m) { put(m, 1, make_leaf(0, 0xffffffff)); }, "its list has the words 0 to 4294967294",
       "would take 42949"},
      {"an unknown triangle", [](bih_memory& m) { m.words[3][1] = 2; },
       "m: node 2 (from the root: 0 2): word 1 of its list is triangle 2; expected one of the 2", "accepted"},
  };
  for (const row& r : table) {
    CAPTURE(r.name);
    bih_memory memory = smallest();
    r.damage(memory);
    CHECK_THAT(refusal(memory), Catch::Contains(r.message));
    CHECK_THAT(refusal(memory, {true, true}), Catch::Contains(r.raw));
  }
  bih_memory empty = smallest();
  put(empty, 1, make_leaf(0, 0));
  CHECK(refusal(empty, {true, false}) == "accepted");
}

TEST_CASE("hierarchies too deep for the stack, and too long for a ray", "[bih_memory]") {
  CHECK(check_bih(ladder(31), "m").stack_entries == 31);
  CHECK_THAT(refusal(ladder(32)),
             Catch::StartsWith("m: node 61 (from the root: 0 1 3 5 7 9 ... 51 53 55 57 59 61): a ray may push 32 entries"));
  CHECK(refusal(ladder(32), {true, true}) == "accepted");
  CHECK(check_bih(ladder(400), "m", {true, true}).stack_entries == 255);

  // Each level shares the next: 2^20 ways to the end.
  bih_memory shared(10);
  shared.triangles.resize(1);
  for (std::uint32_t i = 0; i <= 40; ++i) put(shared, i, make_inner(0, (i + 1) / 2 * 2 + 1, 0, 0));
  put(shared, 41, make_leaf(0, 1));
  put(shared, 42, make_leaf(0, 1));
  put(shared, 43, make_leaf(0, 1));
  CHECK(check_bih(shared, "m").most_cycles > 1'000'000);
  put(shared, 41, make_leaf(0, 100));
  CHECK_THAT(refusal(shared, {true, true}), Catch::Contains("m: a ray through it all would take "));
}

}  // namespace rtusim
