// What tells one point of a sweep from another, and which points share their walks.

#include "testbench/sweep/sweep_identity.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "modules/config/error.h"
#include "testbench/kinds/bih_model.h"
#include "testbench/kinds/bih_walker.h"
#include "testbench/kinds/svo_model.h"
#include "testbench/kinds/svo_walker.h"
#include "testbench/replay/replay.h"
#include "testbench/tests/scratch.h"

namespace rtusim {
namespace {

namespace fs = std::filesystem;
using test::scratch_folder;

const std::string source = RTUSIM_SOURCE_DIR;

void copy(const scratch_folder& folder, const std::string& from, const std::string& to) {
  fs::copy_file(source + from, folder / to, fs::copy_options::overwrite_existing);
}

/// The tasks of a sweep over one scene and, if named, one architecture.
std::vector<sweep_task> tasks(const scratch_folder& folder, const std::string& scene, const std::string& architecture,
                              const std::string& lines) {
  const std::string designs = architecture.empty() ? "" : "architectures = [\"" + architecture + "\"]\n";
  // The tasks point into the plan, which does not outlive them.
  std::vector<sweep_task> all =
      tasks_of(sweep_plan(folder.file("sweep.toml", "[sweep]\nscenes = [\"" + scene + "\"]\n" + designs + lines)));
  for (sweep_task& t : all) t.point = nullptr;
  return all;
}

sweep_task task(const scratch_folder& folder, const std::string& scene, const std::string& architecture = "",
                const std::string& lines = "") {
  const auto all = tasks(folder, scene, architecture, lines);
  REQUIRE(all.size() == 1);
  CHECK(all[0].failure.empty());
  return all[0];
}

// --- parameters ---

/// A parameter's value, and others that it may have, as TOML.
struct turns {
  std::string now;
  std::vector<std::string> others;
};

turns turns_of(const config::parameter& p) {
  turns t;
  if (const auto* flag = std::get_if<config::flag_slot>(&p.slot)) {
    t = {*flag->at ? "true" : "false", {*flag->at ? "false" : "true"}};
  } else if (const auto* number = std::get_if<config::unsigned_slot>(&p.slot)) {
    const std::uint64_t value = number->get(number->at);
    t.now = std::to_string(value);
    if (p.key == "scene.resolution") {  // a power of two
      t.others = {std::to_string(2 * value)};
    } else {
      if (value < number->limits.most) t.others.push_back(std::to_string(value + 1));
      if (value > number->limits.least) t.others.push_back(std::to_string(value - 1));
    }
    if (!number->word.empty()) t.others.push_back(fmt::format("\"{}\"", number->word));
  } else if (const auto* real = std::get_if<config::real_slot>(&p.slot)) {
    t = {fmt::format("{}", *real->at), {fmt::format("{}", *real->at + 0.25)}};
  } else if (const auto* vector = std::get_if<config::vector_slot>(&p.slot)) {
    const auto text = [](const std::array<double, 3>& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); };
    t.now = text(*vector->at);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<double, 3> v = *vector->at;
      v[axis] += 0.25;
      t.others.push_back(text(v));
    }
  } else if (const auto* choice = std::get_if<config::choice_slot>(&p.slot)) {
    for (unsigned i = 0; i < choice->words.size(); ++i) {
      const std::string word = fmt::format("\"{}\"", choice->words[i]);
      if (i == choice->get())
        t.now = word;
      else
        t.others.push_back(word);
    }
  }
  return t;  // texts are paths: theirs are turned as files
}

/// Sets a parameter in its place, whether the design reads it or not; gives a function that takes that back.
std::function<void()> turned_in_place(const config::parameter& p) {
  if (const auto* flag = std::get_if<config::flag_slot>(&p.slot)) {
    bool* const at = flag->at;
    *at = !*at;
    return [at] { *at = !*at; };
  }
  if (const auto* number = std::get_if<config::unsigned_slot>(&p.slot)) {
    const std::uint64_t before = number->get(number->at);
    number->set(number->at, before < number->limits.most ? before + 1 : before - 1);
    return [number, before] { number->set(number->at, before); };
  }
  if (const auto* real = std::get_if<config::real_slot>(&p.slot)) {
    double* const at = real->at;
    const double before = *at;
    *at += 0.25;
    return [at, before] { *at = before; };
  }
  if (const auto* vector = std::get_if<config::vector_slot>(&p.slot)) {
    auto* const at = vector->at;
    const auto before = *at;
    (*at)[2] += 0.25;
    return [at, before] { *at = before; };
  }
  if (const auto* choice = std::get_if<config::choice_slot>(&p.slot); choice != nullptr && choice->words.size() > 1) {
    const unsigned before = choice->get();
    choice->set(before == 0 ? 1 : 0);
    return [choice, before] { choice->set(before); };
  }
  return {};
}

/// A run, and which parameters or sections it has no use for.
struct base {
  std::string scene;         // lines
  std::string architecture;  // lines
  std::set<std::string> unread;
};

const std::set<std::string> of_octree_cores{
    "driver.last_sign_only", "driver.only_zero_replaced", "fixed_point", "float_to_fixed", "svo_core", "memory"};
const std::set<std::string> of_triangle_cores{"driver.norm", "driver.skip_misses", "quantisation", "bih_builder",
                                              "bih_core",    "t_div.kind",         "triangle_unit"};
const std::set<std::string> of_thesis{"camera.near", "camera.far", "camera.rotation"};
const std::set<std::string> of_aimed{"camera.projection", "camera.target", "camera.up"};
const std::set<std::string> of_orbit{"camera.distance", "camera.azimuth_degrees", "camera.elevation_degrees"};

std::set<std::string> all_of(std::initializer_list<std::set<std::string>> sets) {
  std::set<std::string> sum{"t_div.width"};  // of the unit alone
  for (const auto& s : sets) sum.insert(s.begin(), s.end());
  return sum;
}

constexpr auto small_frame = "[frame]\nwidth = 16\nheight = 9\n";

std::vector<base> bases() {
  const std::string frame = small_frame;
  return {
      // A memory and a stack that just hold the octree.
      {"[scene]\nmodel = \"octree.svo\"\n" + frame, "[memory]\naddress_bits = 10\n[svo_core]\nstack_depth = 4\n",
       all_of({of_triangle_cores,
               of_aimed,
               of_orbit,
               {"source.gap_cycles", "source.interval_cycles", "source.seed", "sink.seed", "scene.rays", "scene.resolution",
                "scene.patch_quads", "camera.height"}})},
      {"[scene]\nmodel = \"mesh.obj\"\n" + frame + "[camera]\nkind = \"look_at\"\n[source]\nvalid = \"gap\"\n", "",
       all_of({of_triangle_cores,
               of_thesis,
               of_orbit,
               {"source.interval_cycles", "source.seed", "sink.seed", "scene.rays", "scene.patch_quads", "camera.height"}})},
      {"[scene]\nmodel = \"patch.bpt\"\n" + frame +
           "[camera]\nkind = \"orbit\"\nprojection = \"orthographic\"\n[source]\nvalid = \"lfsr\"\n[sink]\nready = \"lfsr\"\n",
       "",
       all_of({of_triangle_cores,
               of_thesis,
               {"source.gap_cycles", "source.interval_cycles", "scene.rays", "camera.position", "camera.vertical_fov_degrees"}})},
      {"[scene]\nmodel = \"octree.svo\"\nrays = \"rays.csv\"\n" + frame, "",
       all_of({of_triangle_cores,
               {"source.gap_cycles", "source.interval_cycles", "source.seed", "sink.seed", "scene.resolution", "scene.patch_quads",
                "camera"}})},
      {"[scene]\nmodel = \"mesh.obj\"\n" + frame, "[rtu]\ncore = \"bih\"\n[bih_builder]\nleaf_triangles = 2\n[source]\nvalid = \"paced\"\n",
       all_of({of_octree_cores,
               of_aimed,
               of_orbit,
               {"source.gap_cycles", "source.seed", "sink.seed", "scene.rays", "scene.patch_quads", "camera.height"}})},
      {"[scene]\nmodel = \"patch.bpt\"\nrays = \"rays.csv\"\n" + frame, "[rtu]\ncore = \"bih\"\n",
       all_of({of_octree_cores, {"source.gap_cycles", "source.interval_cycles", "source.seed", "sink.seed", "camera"}})},
  };
}

void write_inputs(const scratch_folder& folder) {
  copy(folder, "/testbench/golden/svo/models/dragon_32.svo", "octree.svo");
  copy(folder, "/testbench/tests/cases/mesh_cubes_overlapping.obj", "mesh.obj");
  // One bent patch.
  std::string patch = "1\n3 3\n";
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) patch += fmt::format("{} {} {}\n", i, j, i * j * (3 - j) * 0.2);
  folder.file("patch.bpt", patch);
  std::string rays = "ox,oy,oz,dx,dy,dz\n";
  for (int i = 0; i < 40; ++i)
    rays += fmt::format("{},{},-3,{},{},1\n", 0.04 * i - 0.8, 0.9 - 0.045 * i, 0.3 - 0.015 * i, i % 3 == 0 ? 0 : 0.01 * i - 0.2);
  folder.file("rays.csv", rays);
}

bool is_among(const std::set<std::string>& keys_or_sections, const std::string& key) {
  return keys_or_sections.count(key) != 0 || keys_or_sections.count(key.substr(0, key.find('.'))) != 0;
}

/// What points with the same walks share.
struct shared {
  std::vector<std::uint32_t> octree;
  std::array<std::vector<std::uint64_t>, 4> hierarchy;
  per_axis<std::int64_t> corner{};
  std::vector<std::array<std::int64_t, 10>> triangles;
  std::vector<std::array<std::uint32_t, 8>> jobs;
  std::vector<std::vector<std::int64_t>> walks;  // with `cost` and the place of the hit
  std::array<double, 7> place{};                 // of the model in the world
  unsigned edge_shift = 0;
  std::uint64_t overflows = 0;
  std::string refusal;

  bool operator==(const shared& o) const {
    return std::tie(octree, hierarchy, corner, triangles, jobs, walks, place, edge_shift, overflows, refusal) ==
           std::tie(o.octree, o.hierarchy, o.corner, o.triangles, o.jobs, o.walks, o.place, o.edge_shift, o.overflows, o.refusal);
  }
};

shared shared_of(const run_setup& s) {
  shared all;
  try {
    const auto model = s.host().load(s.hardware, s.what);
    const sent_jobs sent = model->jobs(s.hardware, s.what, 1, false);
    for (const job_packet& j : sent.packets)
      all.jobs.push_back({j.job_word, j.t0[0], j.t0[1], j.t0[2], j.t1[0], j.t1[1], j.t1[2], j.address});
    if (const auto* of_triangles = dynamic_cast<const bih_model*>(model.get())) {
      const triangle_model* const t = &of_triangles->triangles();
      all.hierarchy = t->hierarchy.words;
      all.corner = t->hierarchy.corner;
      for (const accelerated_triangle& a : t->hierarchy.triangles)
        all.triangles.push_back({a.pp, a.pq, a.d, a.e1p, a.e1q, a.e2p, a.e2q, a.np, a.nq, a.r});
      const grid_mapping& g = t->grid;
      all.place = {g.scale, g.centre[0], g.centre[1], g.centre[2], g.corner[0], g.corner[1], g.corner[2]};
      all.edge_shift = t->edge_shift;
      const auto rays = walk_rays(*model->walker(s.hardware), sent.packets, 1);
      const auto& walked = dynamic_cast<const walked_as<bih_way::walked_ray, bih_way::jobs_type>&>(*rays);
      for (std::size_t i = 0; i < walked.size(); ++i) {
        const bih_way::walked_ray& r = walked.rays[i];
        all.walks.push_back({r.job_word, r.cost, r.hit, r.triangle, r.t_hit, r.u, r.v, r.inner, r.push, r.pop, r.leaf, r.pairs, r.hits,
                             r.errors, r.wrapped, r.max_stack, r.overflow});
      }
      return all;
    }
    all.octree = dynamic_cast<const svo_model&>(*model).octree();
    const auto rays = walk_rays(*model->walker(s.hardware), sent.packets, 1);
    const auto& walked = dynamic_cast<const walked_as<svo_way::walked_ray, svo_way::jobs_type>&>(*rays);
    for (std::size_t i = 0; i < walked.size(); ++i) {
      const svo_walked& r = walked.rays[i];
      all.walks.push_back({r.job_word, r.cost, r.pushes, r.depth, r.hit, r.overflow, r.hit ? r.t_hit : 0, r.hit ? r.axis : 0});
    }
    all.overflows = walked.jobs.conversion.overflows;
  } catch (const input_error& e) {
    all.refusal = e.what();
  }
  return all;
}

/// What rays' walks, their packets and the model in the memories depend on. All else leaves them as they are.
const std::set<std::string> walked_on{
    "scene",         "frame",   "camera",       "driver",      "fixed_point",           "float_to_fixed",
    "svo_core",      "memory",  "quantisation", "bih_builder", "bih_core.address_bits", "bih_core.early_out",
    "triangle_unit", "rtu.core"};
/// What they may depend on, though not here: on ties, rays beside the box, deep stacks, leaves without triangles; and the divider that no
/// replay covers.
const std::set<std::string> walked_on_elsewhere{"bih_core.exit_at_zero", "bih_core.box_never_misses", "bih_core.stack_wraps",
                                                "bih_core.empty_leaf_hangs", "t_div"};

}  // namespace

TEST_CASE("sweep identity: each parameter counts exactly where the design reads it", "[testbench]") {
  const scratch_folder folder;
  write_inputs(folder);
  std::set<std::string> unread, read;
  for (const base& b : bases()) {
    run_sources from;
    from.scene = folder.file("scene.toml", b.scene);
    // Source and sink are told with the design or with the scene.
    from.architecture = folder.file("architecture.toml", b.architecture);
    const run_setup s(from);
    const std::string before = identity_of(s, {});
    for (const auto& section : s.parameters.sections())
      for (const auto& p : section.parameters()) {
        const bool expected = !is_among(b.unread, p.key);
        CAPTURE(b.scene, p.key, expected);
        (expected ? read : unread).insert(p.key);
        const auto back = turned_in_place(p);
        if (!back) {  // a path, or a choice of one word
          CHECK((std::holds_alternative<config::text_slot>(p.slot) || p.key == "memory.kind" || p.key == "result_manager.order"));
          continue;
        }
        CHECK((identity_of(s, {}) != before) == expected);
        back();
        REQUIRE(identity_of(s, {}) == before);
      }
  }
  // Each other one was turned in a run that reads it.
  for (const std::string& key : read) unread.erase(key);
  CHECK(unread == std::set<std::string>{"t_div.width"});
}

TEST_CASE("sweep identity: points share their walks exactly where these are the same", "[testbench]") {
  const scratch_folder folder;
  write_inputs(folder);
  std::set<std::string> kept, changed;  // by parameter: what it does to the walks, in some run
  for (const base& b : bases()) {
    folder.file("scene.toml", b.scene);
    run_sources from;
    from.scene = folder / "scene.toml";
    from.architecture = folder.file("architecture.toml", b.architecture);
    const run_setup s(from);
    const shared before = shared_of(s);
    REQUIRE(before.refusal.empty());
    REQUIRE_FALSE(before.jobs.empty());
    for (const auto& section : s.parameters.sections())
      for (const auto& p : section.parameters()) {
        if (is_among(b.unread, p.key)) continue;
        const turns t = turns_of(p);
        for (const std::string& other : t.others) {
          const sweep_plan plan(
              folder.file("sweep.toml", fmt::format("[sweep]\nscenes = [\"scene.toml\"]\narchitectures = [\"architecture.toml\"]\n"
                                                    "[axes]\n\"{}\" = [{}, {}]\n",
                                                    p.key, t.now, other)));
          const auto two = tasks_of(plan);
          CAPTURE(b.scene, p.key, t.now, other);
          REQUIRE(two.size() == 2);
          // One that makes others unread, which the files give, is refused.
          if (!two[1].failure.empty()) {
            CHECK_THAT(two[1].failure, Catch::Contains("is not read by this design") || Catch::Contains(", a design of "));
            continue;
          }
          CHECK(two[0].identity != two[1].identity);
          CHECK(two[0].name != two[1].name);
          const bool same_key = two[0].walk == two[1].walk;
          CHECK(same_key == !(is_among(walked_on, p.key) || is_among(walked_on_elsewhere, p.key)));
          const bool same_walks = shared_of(*plan.setup(plan.points()[1])) == before;
          if (same_key) CHECK(same_walks);
          (same_walks ? kept : changed).insert(p.key);
        }
      }
  }
  // Each section of the key is one without which some of these points would have met with the walks of others.
  for (const std::string& key : walked_on) {
    CAPTURE(key);
    CHECK(std::any_of(changed.begin(), changed.end(), [&](const std::string& c) { return is_among({key}, c); }));
  }
  // And of all else nothing was, so that points do share.
  for (const char* key :
       {"rtu.cores", "rtu.clock_mhz", "scheduler.policy", "result_manager.valid_withdrawn", "source.valid", "source.gap_cycles",
        "source.interval_cycles", "source.seed", "sink.ready", "sink.seed", "watchdog.cycles", "bih_core.rays_in_flight"}) {
    CAPTURE(key);
    CHECK(kept.count(key) == 1);
    CHECK(changed.count(key) == 0);
  }
}

TEST_CASE("sweep identity: what files hold counts, not where they lie", "[testbench]") {
  const scratch_folder folder;
  write_inputs(folder);
  fs::create_directory(folder / "elsewhere");
  const auto in = [](const std::string& model, const std::string& more = "") {
    return "[scene]\nmodel = \"" + model + "\"\n" + small_frame + more;
  };
  const auto differ = [](const sweep_task& a, const sweep_task& b) {
    CHECK(a.identity != b.identity);
    CHECK(a.name != b.name);
    CHECK(a.walk != b.walk);
  };
  const auto agree = [](const sweep_task& a, const sweep_task& b) {
    CHECK(a.identity == b.identity);
    CHECK(a.name == b.name);
    CHECK(a.walk == b.walk);
  };
  const auto append = [&](const std::string& file, const std::string& bytes) {
    std::ofstream(folder / file, std::ios::binary | std::ios::app) << bytes;
  };

  folder.file("scene.toml", in("mesh.obj"));
  folder.file("design.toml", "[rtu]\ncores = 4\n");
  const sweep_task first = task(folder, "scene.toml", "design.toml");
  REQUIRE(first.inputs.size() == 1);
  CHECK(first.name.size() == 16);
  CHECK(nlohmann::json::parse(first.identity).at("inputs") == nlohmann::json{first.inputs[0].sha256});
  CHECK(first.identity.find("mesh") == std::string::npos);  // no name

  SECTION("A scene and a design elsewhere, in other words") {
    copy(folder, "/testbench/tests/cases/mesh_cubes_overlapping.obj", "elsewhere/other name.obj");
    folder.file("elsewhere/other.toml", "# a comment\nframe = {height = 9, width = 16}\nscene.model = 'other name.obj'\n");
    folder.file("elsewhere/unit.toml", "[[rtu.core]]\ncount = 4\nkind = 'svo'\n[scheduler]\npolicy = 'cyclic_first_available'\n");
    agree(first, task(folder, "elsewhere/other.toml", "elsewhere/unit.toml"));
  }
  SECTION("A value of the scene") {
    folder.file("scene.toml", in("mesh.obj", "[camera]\nnear = 0.01\n"));
    differ(first, task(folder, "scene.toml", "design.toml"));
  }
  SECTION("A value of the design that leaves the walks as they are, and one that does not") {
    folder.file("design.toml", "[rtu]\ncores = 5\n");
    const sweep_task five = task(folder, "scene.toml", "design.toml");
    CHECK(five.identity != first.identity);
    CHECK(five.name != first.name);
    CHECK(five.walk == first.walk);
    folder.file("design.toml", "[rtu]\ncores = 4\n[svo_core]\nstack_depth = 10\n");
    differ(first, task(folder, "scene.toml", "design.toml"));
  }
  SECTION("A byte of the model, even in a comment") {
    append("mesh.obj", "# more\n");
    differ(first, task(folder, "scene.toml", "design.toml"));
  }
  SECTION("The ending, which tells how a file is read") {
    copy(folder, "/testbench/tests/cases/mesh_cubes_overlapping.obj", "model.ply");
    folder.file("scene.toml", in("model.ply"));
    differ(first, task(folder, "scene.toml", "design.toml"));
  }
  SECTION("A list of rays, its values and its place") {
    folder.file("scene.toml", in("mesh.obj").insert(8, "rays = \"rays.csv\"\n"));
    const sweep_task listed = task(folder, "scene.toml", "design.toml");
    differ(first, listed);
    CHECK(listed.inputs.size() == 2);
    fs::copy_file(folder / "rays.csv", folder / "elsewhere/list.csv");
    folder.file("scene.toml", in("mesh.obj").insert(8, "rays = \"elsewhere/list.csv\"\n"));
    agree(listed, task(folder, "scene.toml", "design.toml"));
    append("elsewhere/list.csv", "0,0,-3,0,0,1\n");
    differ(listed, task(folder, "scene.toml", "design.toml"));
  }
  SECTION("The buffer beside a glTF") {
    for (const char* to : {"", "elsewhere/"}) {
      copy(folder, "/testbench/tests/cases/gltf_uri_percent.gltf", to + std::string("model.gltf"));
      copy(folder, "/testbench/tests/cases/buffer with blank.bin", to + std::string("buffer with blank.bin"));
    }
    folder.file("scene.toml", in("model.gltf"));
    const sweep_task whole = task(folder, "scene.toml");
    CHECK(whole.inputs.size() == 2);
    folder.file("elsewhere/scene.toml", in("model.gltf"));
    agree(whole, task(folder, "elsewhere/scene.toml"));
    append("elsewhere/buffer with blank.bin", "x");  // behind what is used
    differ(whole, task(folder, "elsewhere/scene.toml"));
  }
}

TEST_CASE("sweep identity: a file that changed while the sweep ran is named", "[testbench]") {
  const config::input_file mesh{"mesh.gltf", "/x/mesh.gltf", 3, "aa"}, buffer{"mesh.bin", "/x/mesh.bin", 4, "bb"};
  config::input_file other = buffer;
  other.sha256 = "bc";
  config::input_file moved = buffer;
  moved.file = "moved.bin";
  CHECK(changed_input({mesh, buffer}, {mesh, buffer}, true).empty());
  CHECK(changed_input({mesh, buffer}, {mesh, moved}, true).empty());
  CHECK(changed_input({mesh, buffer}, {mesh, other}, true) == "mesh.bin");
  CHECK(changed_input({mesh, buffer}, {mesh, other}, false) == "mesh.bin");
  // One that is read once more with other contents, or one more.
  CHECK(changed_input({mesh}, {mesh, buffer}, true) == "mesh.bin");
  CHECK(changed_input({mesh}, {mesh, buffer}, false) == "mesh.bin");
  // One that was not read.
  CHECK(changed_input({mesh, buffer}, {mesh}, true) == "mesh.bin");
  CHECK(changed_input({mesh, buffer}, {mesh}, false).empty());
  CHECK(changed_input({mesh, buffer}, {}, false).empty());
  CHECK(changed_input({}, {}, true).empty());
}

}  // namespace rtusim
