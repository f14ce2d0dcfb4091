#include "testbench/run/run_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "testbench/run/job_file.h"
#include "testbench/tests/picture_reading.h"
#include "testbench/tests/program.h"
#include "testbench/tests/scratch.h"
#include "testbench/tests/vcd.h"

// The pictures of a run against its log, its waveform and its jobs, pixel by pixel.
namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
using test::near;
using test::png;
using test::rgb;
using test::words;
using vec = std::array<double, 3>;

const std::string source = RTUSIM_SOURCE_DIR "/";
constexpr unsigned width = 32, height = 20;

/// A run with everything that tells of its results.
struct recorded {
  test::scratch_folder folder;
  test::layers channels;
  std::map<std::uint32_t, std::map<std::string, std::int64_t>> log;  // a line by its pixel
  std::vector<job_packet> jobs;
  std::map<std::uint32_t, std::uint64_t> latency;  // from the waveform, by pixel
  json record;

  explicit recorded(words arguments) {
    arguments.insert(arguments.begin(), "run");
    for (const char* a :
         {"--set",   "frame.width=32", "--set",      "frame.height=20", "--set",      "rtu.clock_mhz=100", "--quiet",     "--log",
          "log.csv", "--save-jobs",    "jobs.bin",   "--stats",         "s.json",     "--image",           "x.exr",       "--image",
          "x.png",   "--image",        "x.heat.png", "--image",         "x.wait.png", "--image",           "x.depth.png", "--vcd",
          "w.vcd",   "--vcd-all"})
      arguments.emplace_back(a);
    CAPTURE(arguments);
    const test::outcome o = test::rtusim(folder, arguments);
    CAPTURE(o.err);
    REQUIRE(o.status == 0);
    channels = test::read_layers(folder / "x.exr");
    jobs = read_jobs(folder / "jobs.bin");
    record = json::parse(test::bytes_of(folder / "s.json"));
    read_log();
    // Jobs are accepted in their order.
    const auto accepted = test::vcd(folder / "w.vcd").transfers("job");
    REQUIRE(accepted.size() == jobs.size());
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const std::uint32_t pixel = jobs[k].job_word & 0xfffffff;
      latency[pixel] = static_cast<std::uint64_t>(log.at(pixel).at("cycle")) - accepted[k];
    }
  }
  float at(const char* channel, std::size_t pixel) const { return channels.at(channel).at(pixel); }
  vec three(const char* channel, std::size_t pixel) const {
    vec v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = static_cast<double>(at((std::string(channel) + '.' + "xyz"[i]).c_str(), pixel));
    return v;
  }

  /// What both kinds of cores have in common. `cost`: the log's name for it; `way`: of a ray that waits for nobody, beside its cost.
  void check_numbers(const char* cost, std::uint64_t way) const {
    REQUIRE(log.size() == jobs.size());
    std::vector<std::uint64_t> costs, waits;
    for (std::uint32_t i = 0; i < width * height; ++i) {
      CAPTURE(i);
      const auto line = log.find(i);
      if (line == log.end()) {
        for (const char* name : {"hit", "depth", "cost", "latency", "wait", "normal.x", "normal.y", "normal.z", "position.x"})
          CHECK(at(name, i) == 0);
        CHECK(at("model", i) == -1);
        continue;
      }
      const auto& l = line->second;
      const auto clocks = static_cast<std::uint64_t>(l.at(cost));
      CHECK(at("hit", i) == static_cast<float>(l.at("hit")));
      CHECK(at("model", i) == static_cast<float>(l.at("hit") - 1));
      CHECK(at("cost", i) == static_cast<float>(clocks));
      CHECK(at("core", i) == static_cast<float>(l.at("core")));
      CHECK(at("latency", i) == static_cast<float>(latency.at(i)));
      REQUIRE(latency.at(i) >= clocks + way);
      CHECK(at("wait", i) == static_cast<float>(latency.at(i) - clocks - way));
      costs.push_back(clocks);
      waits.push_back(latency.at(i) - clocks - way);
    }
    const auto told = [](std::vector<std::uint64_t> all, const std::string& title, const std::string& unit) {
      std::sort(all.begin(), all.end());
      const double least = static_cast<double>(all.front()), most = static_cast<double>(all.back());
      const double usual = static_cast<double>(all[(all.size() * 995 + 999) / 1000 - 1]);
      const bool cut = usual > least && most > least + 1.25 * (usual - least);
      const auto grouped = [](std::string n) {
        for (int place = static_cast<int>(n.size()) - 3; place > 0; place -= 3) n.insert(static_cast<std::size_t>(place), ",");
        return n;
      };
      return title + ": colours from " + grouped(std::to_string(all.front())) + " to " +
             grouped(std::to_string(static_cast<std::uint64_t>(cut ? usual : most))) + ' ' + unit + (cut ? " and more" : "");
    };
    CHECK(png(folder / "x.heat.png").description == told(costs, "Cost", "cycles"));
    CHECK(png(folder / "x.wait.png").description == told(waits, "Wait", "cycles"));
  }

  /// Where the picture of depths is light and where it is dark.
  void check_depths() const {
    double least = 1e9, most = 0;
    for (std::size_t i = 0; i < width * height; ++i)
      if (at("hit", i) == 1) {
        least = std::min(least, static_cast<double>(at("depth", i)));
        most = std::max(most, static_cast<double>(at("depth", i)));
      }
    REQUIRE(most > least);
    const png shown(folder / "x.depth.png");
    for (std::size_t i = 0; i < width * height; ++i) {
      const double grey = 0.95 - 0.8 * (static_cast<double>(at("depth", i)) - least) / (most - least);
      CHECK(near(shown.pixels[i], at("hit", i) == 1 ? test::bytes_of_colour(grey, grey, grey) : test::bytes_of_colour(0.08, 0.12, 0.3)));
    }
  }

 private:
  void read_log() {
    std::istringstream in(test::bytes_of(folder / "log.csv"));
    std::string line, name;
    std::vector<std::string> names;
    std::getline(in, line);
    for (std::istringstream header(line); std::getline(header, name, ',');) names.push_back(name);
    while (std::getline(in, line)) {
      std::map<std::string, std::int64_t> fields;
      std::istringstream cells(line);
      for (const std::string& n : names) {
        std::getline(cells, name, ',');
        fields[n] = std::stoll(name);
      }
      REQUIRE(log.emplace(fields.at("job_id") & 0xfffffff, fields).second);
    }
  }
};

double value_of(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

double length_of(const vec& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

}  // namespace

TEST_CASE("run pictures: of voxel cores every pixel shows its line of the log") {
  for (const char* architecture : {"espe2019", "espe2019_as_built"}) {
    const bool as_built = std::string(architecture) != "espe2019";
    CAPTURE(architecture);
    const recorded run({"--model", source + "testbench/golden/svo/models/dragon_32.svo", "--arch",
                        source + "testbench/architectures/" + architecture + ".toml", "--set", "rtu.cores=3"});
    run.check_numbers("cost", 6 + 1);  // the job manager's stages and the core's cycle of handing over
    run.check_depths();
    const json& eye = run.record["parameters"]["camera"]["position"];
    const png shaded(run.folder / "x.png");
    std::size_t hits = 0, signs[2] = {0, 0}, axes[3] = {0, 0, 0};
    for (std::uint32_t i = 0; i < width * height; ++i) {
      CAPTURE(i);
      const auto& l = run.log.at(i);
      const vec normal = run.three("normal", i);
      if (l.at("hit") == 0) {
        CHECK(shaded.pixels[i] == rgb{255, 255, 255});
        CHECK(run.at("depth", i) == 0);
        CHECK(normal == vec{0, 0, 0});
        CHECK(run.three("voxel", i) == vec{-1, -1, -1});
        CHECK(run.three("position", i) == vec{0, 0, 0});
        continue;
      }
      ++hits;
      const auto axis = static_cast<std::size_t>(l.at("normal_axis"));
      const int grey = axis == 0 ? 178 : axis == 1 ? 229 : 127;
      CHECK(shaded.pixels[i] == rgb{grey, grey, grey});
      const double depth = static_cast<double>(run.at("depth", i));
      CHECK(depth == static_cast<double>(static_cast<float>(static_cast<double>(l.at("t_hit")) / 65536)));
      // The face that a ray comes upon looks against it; a bit of the job word tells that the ray runs down that axis. As built it has no
      // sign.
      const bool down = (l.at("job_id") >> (28 + axis) & 1) != 0;
      vec expected{};
      expected[axis] = as_built || down ? 1 : -1;
      CHECK(normal == expected);
      ++signs[expected[axis] > 0];
      ++axes[axis];
      // The hit lies as far from the eye as its depth tells, on the face of its voxel.
      const vec at = run.three("position", i), voxel = run.three("voxel", i);
      vec way{};
      for (std::size_t k = 0; k < 3; ++k) way[k] = at[k] - eye[k].get<double>();
      if (!as_built) {                                                    // where words tell but one of the axes that a ray runs down
        CHECK(length_of(way) - depth == Approx(0.00115).margin(0.0005));  // rays begin on the near plane, 0.001 before the eye
        CHECK((way[axis] < 0) == down);
      }
      const double face = voxel[axis] + (down ? 1 : 0);
      CHECK((at[axis] + 1) * 16 == Approx(face).margin(0.02));
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK((at[k] + 1) * 16 > voxel[k] - 0.05);
        CHECK((at[k] + 1) * 16 < voxel[k] + 1.05);
      }
    }
    CHECK(hits > 50);
    for (const std::size_t n : axes) CHECK(n > 1);
    CHECK(signs[1] > 0);
    CHECK((signs[0] > 0) == !as_built);
    CHECK(run.record["statistics"]["hits"] == hits);
  }
}

TEST_CASE("run pictures: of triangle cores every pixel shows its line of the log") {
  const recorded run({"--model", source + "scenes/data/teapot.bpt", "--arch", source + "testbench/architectures/hanika2007.toml", "--set",
                      "rtu.cores=2", "--set", "scene.patch_quads=4"});
  run.check_numbers("clocks", 72 + 45);  // the job manager's and the intersector's stages
  run.check_depths();
  const png shaded(run.folder / "x.png");
  const json& eye = run.record["parameters"]["camera"]["position"];
  std::map<std::uint32_t, const job_packet*> jobs;
  for (const job_packet& j : run.jobs) jobs[j.job_word] = &j;
  std::size_t hits = 0;
  for (std::uint32_t i = 0; i < width * height; ++i) {
    CAPTURE(i);
    if (run.at("hit", i) == 0) {
      CHECK(run.at("triangle", i) == -1);
      CHECK(run.at("depth", i) == 0);
      CHECK(shaded.pixels[i] == rgb{255, 255, 255});
      continue;
    }
    ++hits;
    CHECK(run.at("triangle", i) == static_cast<float>(run.log.at(i).at("tri")));
    const vec n = run.three("normal", i), at = run.three("position", i);
    CHECK(length_of(n) == Approx(1).margin(1e-5));
    const int grey = static_cast<int>(255 * (0.2 + 0.75 * std::clamp((0.4 * n[0] + 0.8 * n[1] + 0.45 * n[2] + 1) / 2, 0.0, 1.0)));
    CHECK(near(shaded.pixels[i], {grey, grey, grey}));
    // The hit lies on the job's ray, as far from the eye as its depth tells, and its face looks there.
    vec way{};
    double facing = 0, along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      way[k] = at[k] - eye[k].get<double>();
      facing += way[k] * n[k];
      along += way[k] * value_of(jobs.at(i)->t1[k]);
      CHECK(std::fabs(at[k]) < 0.9801);
    }
    CHECK(facing < 0);
    CHECK(length_of(way) - static_cast<double>(run.at("depth", i)) == Approx(0.00115).margin(0.0002));  // from the near plane on
    CHECK(along == Approx(length_of(way)).epsilon(1e-4));
  }
  CHECK(hits > 25);
  CHECK(run.record["statistics"]["hits"] == hits);
}

TEST_CASE("run pictures: a cube's faces, each with its normal, where it stands") {
  // A cube of 2 within a box of 4, which becomes one of 1.96 in the world; faces x, y, z in pairs as the file has them.
  const test::scratch_folder models;
  const auto model =
      models.file("boxed.obj", test::bytes_of(source + "testbench/tests/cases/mesh_cube.obj") +
                                   "v -2 -2 -2\nv -2 -2 -1.99\nv -2 -1.99 -2\nv 2 2 2\nv 2 2 1.99\nv 2 1.99 2\nf 9 10 11\nf 12 13 14\n");
  for (const char* t_halved : {"false", "true"}) {
    const recorded run({"--model", model.string(), "--arch", source + "testbench/architectures/hanika2007.toml", "--set",
                        std::string("errata.t_halved=") + t_halved, "--set", "quantisation.edge_shift=0"});
    const vec outward[] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
    std::size_t hits = 0;
    for (std::uint32_t i = 0; i < width * height; ++i) {
      if (run.at("hit", i) == 0) continue;
      ++hits;
      CAPTURE(t_halved, i);
      const auto face = static_cast<std::size_t>(run.at("triangle", i)) / 2;
      REQUIRE(face < 6);
      const vec normal = run.three("normal", i), at = run.three("position", i);
      CHECK(normal == outward[face]);
      double along = 0;
      for (std::size_t k = 0; k < 3; ++k) along += at[k] * outward[face][k];
      CHECK(along == Approx(0.49).margin(1e-4));
    }
    CHECK(hits > 30);
  }
}

TEST_CASE("run pictures: the sheet's headline tells the model and the run") {
  const test::scratch_folder folder;
  const std::string voxels = source + "testbench/golden/svo/models/dragon_32.svo";
  const struct {
    words run;
    std::string title, details;
  } runs[] = {
      {{"--model", voxels, "--set", "rtu.cores=1"}, "dragon_32.svo, 32 voxels an edge", "by 1 voxel core in "},
      {{"--model", source + "testbench/tests/cases/mesh_cube.obj", "--arch", source + "testbench/architectures/hanika2007.toml", "--set",
        "rtu.cores=2", "--set", "rtu.clock_mhz=12.5"},
       "mesh_cube.obj, 12 triangles",
       "by 2 triangle cores in "},
  };
  const auto grouped = [](const json& n) {
    std::string text = std::to_string(n.get<std::uint64_t>());
    for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3) text.insert(static_cast<std::size_t>(place), ",");
    return text;
  };
  for (const auto& r : runs) {
    words arguments = r.run;
    arguments.insert(arguments.begin(), "run");
    for (const char* a : {"--set", "frame.width=48", "--set", "frame.height=32", "--quiet", "--stats", "s.json", "--image", "x.sheet.png"})
      arguments.emplace_back(a);
    REQUIRE(test::rtusim(folder, arguments).status == 0);
    const json record = json::parse(test::bytes_of(folder / "s.json"));
    const json& s = record["statistics"];
    const double mhz = record["parameters"]["rtu"]["clock_mhz"].get<double>(), cycles = s["total_cycles"].get<double>();
    char end[100];
    std::snprintf(end, sizeof end, " cycles: %.2f ms at %g MHz", cycles / mhz / 1e3, mhz);
    const std::string details = "48 x 32 pixels, " + grouped(s["rays"]) + " rays traced " + r.details + grouped(s["total_cycles"]) + end;
    const png sheet(folder / "x.sheet.png");
    // The same words on a sheet of our own, whose head is alike.
    write_picture(folder / "own.sheet.png", frame({48, 32}, 16), picture_kind::sheet, {r.title, details});
    const png own(folder / "own.sheet.png");
    CAPTURE(r.title, details);
    REQUIRE(own.width == sheet.width);
    CHECK(std::equal(own.pixels.begin(), own.pixels.begin() + static_cast<std::ptrdiff_t>(92 * own.width), sheet.pixels.begin()));
  }
}

}  // namespace rtusim
