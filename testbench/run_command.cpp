#include "testbench/run_command.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/schema.h"
#include "modules/rtu/design.h"
#include "testbench/driver.h"
#include "testbench/grouped.h"
#include "testbench/job_file.h"
#include "testbench/pictures.h"
#include "testbench/ray_list.h"
#include "testbench/replay.h"
#include "testbench/results_log.h"
#include "testbench/scene.h"
#include "testbench/simulation.h"
#include "testbench/summary.h"
#include "testbench/triangle_model.h"

namespace rtusim {
namespace {

using seconds = std::chrono::duration<double>;
using wall_clock = std::chrono::steady_clock;

/// All that describes a run: the parameters behind one schema.
struct setup {
  design unit;
  surroundings bench;
  scene what;
  config::schema parameters;

  explicit setup(const run_options& o) {
    unit.describe(parameters);
    bench.describe(parameters);
    what.describe(parameters);
    const auto with_bench = [](std::set<std::string> names) {
      names.insert(surroundings::sections().begin(), surroundings::sections().end());
      return names;
    };
    if (!o.architecture.empty()) parameters.read_toml(o.architecture, with_bench(design::sections()));
    if (!o.scene.empty()) {
      parameters.read_toml(o.scene, with_bench(scene::sections()));
      // A path in a scene file starts at its folder; one on the command line starts here.
      for (std::string* path : {&what.model.model, &what.model.rays})
        if (!path->empty()) *path = (o.scene.parent_path() / *path).string();
    }
    // An octree in place of the scene's mesh leaves nothing to divide into voxels.
    if (is_octree(o.model)) parameters.forget("scene.resolution");
    for (const std::string& a : o.assignments) parameters.set(a);
    if (!o.model.empty()) what.model.model = o.model.string();
    parameters.check_read();
    if (!what.model.rays.empty() && !o.jobs.empty()) throw input_error("--jobs", "with scene.rays", "one or the other");
    if (what.model.model.empty()) throw input_error("run", "no model", "a scene file, --model FILE or --set scene.model=FILE");
  }
};

std::uint32_t crc32_of(const void* data, std::size_t bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, static_cast<const Bytef*>(data), bytes));
}

std::optional<waveform_window> window_of(const run_options& o) {
  if (o.waveform.empty()) {
    if (o.waveform_from || o.waveform_to || o.waveform_job)
      throw input_error("--vcd-from, --vcd-to, --vcd-job", "no --vcd", "--vcd OUT.vcd with it");
    return {};
  }
  waveform_window w;
  w.file = o.waveform;
  w.job_id = o.waveform_job;
  if (o.waveform_job && (o.waveform_from || o.waveform_to))
    throw input_error("--vcd-job", "with --vcd-from or --vcd-to", "one or the other");
  w.from = o.waveform_from.value_or(0);
  w.to = o.waveform_to.value_or(never) == never ? never : *o.waveform_to + 1;
  if (o.waveform_to && *o.waveform_to < w.from)
    throw input_error("--vcd-to", fmt::format("{}, before --vcd-from {}", *o.waveform_to, w.from), "the last cycle of the window");
  return w;
}

/// Sees before the run that each output can be written, and to a file of its own.
void check_outputs(const run_options& o) {
  std::vector<std::filesystem::path> outputs{o.save_jobs, o.statistics, o.log, o.waveform};
  outputs.insert(outputs.end(), o.images.begin(), o.images.end());
  std::set<std::filesystem::path> seen;
  for (const auto& file : outputs) {
    if (file.empty()) continue;
    config::check_writable(file);
    const bool is_new = !std::filesystem::exists(file) || std::filesystem::is_regular_file(file);
    if (is_new && !seen.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(file))).second)
      throw input_error(file.string(), "two outputs of this name", "a file for each");
  }
}

/// A line on the terminal that tells how far the run is; nothing in a pipe.
class progress {
 public:
  progress(bool wanted, std::uint64_t rays) : on_(wanted && isatty(STDERR_FILENO) != 0), rays_(rays) {}
  ~progress() {
    if (on_) fmt::print(stderr, "\r\033[K");
  }
  void show(std::uint64_t done) const {
    if (on_) fmt::print(stderr, "\r{:3} % of {} rays", 100 * done / rays_, rays_);
  }

 private:
  bool on_;
  std::uint64_t rays_;
};

struct traced {
  run_figures figures;
  simulator_figures speed;
};

/// What lies in the memories of the cores, as their kind needs it.
struct loaded_model {
  svo_limits limits;
  svo_image octree;
  std::optional<triangle_model> triangles;

  explicit loaded_model(const setup& s) : limits{s.unit.memory_.address_bits, s.unit.svo_core.stack_depth} {
    const scene::model_params& m = s.what.model;
    if (s.unit.has_triangles())
      triangles = load_triangles(m.model, s.unit.quantisation_, s.unit.bih_builder.leaf_triangles, s.unit.bih_core.address_bits, m.patch_quads);
    else
      octree = load_model(m.model, m.resolution, m.patch_quads, limits);
  }
  model_view view() const { return triangles ? model_view(triangles->hierarchy) : model_view(octree.words); }
  /// `pictured`: each ray needs a pixel.
  std::vector<job_packet> jobs(const setup& s, bool pictured) const {
    const driver_params& driver = s.unit.driver;
    if (!s.what.model.rays.empty()) {
      const ray_list rays(s.what.model.rays);
      const frame::params& f = s.what.picture;
      if (pictured && rays.size() != std::size_t{f.width} * f.height)
        throw input_error(s.what.model.rays, fmt::format("{} rays for a frame of {} x {}", rays.size(), f.width, f.height),
                          "frame.width times frame.height of them, or no --image");
      if (triangles) return triangle_jobs(rays, triangles->grid, driver.norm, driver.skip_misses, 2);
      return list_jobs(rays, driver.last_sign_only, 0, 2);
    }
    if (triangles) return triangle_jobs(s.what.view, s.what.picture, triangles->grid, driver.norm, driver.skip_misses, 2);
    return camera_jobs(s.what.view, s.what.picture, driver.last_sign_only, 0, 2);
  }
  unsigned voxels_an_edge() const { return 1u << describe(octree, "model", limits).levels; }
  /// Where the rays that hit met the model. Of a job id that is there twice the result's ray is not known: the last one stands for it.
  frame::places places(const std::vector<job_packet>& jobs, const frame& picture) const {
    frame::places where;
    where.points.resize(picture.pixels().size());
    for (const job_packet& job : jobs) {
      const frame::pixel& p = picture.pixels()[job.pixel()];
      if (!p.hit) continue;
      const double distance = static_cast<double>(p.t_hit);
      const per_axis<float> point = triangles ? point_on_ray(job, triangles->grid, distance) : point_on_ray(job, distance);
      if (std::isfinite(point[0] + point[1] + point[2])) where.points[job.pixel()] = point;
    }
    if (!triangles) where.cells = voxels_an_edge();
    return where;
  }
  /// Words in use, and their checksum.
  std::pair<std::size_t, std::uint32_t> words() const {
    if (!triangles) return {octree.words.size(), crc32_of(octree.words.data(), octree.words.size() * 4)};
    const bih_memory& h = triangles->hierarchy;
    uLong crc = 0;
    for (const auto& w : h.words) crc = crc32_z(crc, reinterpret_cast<const Bytef*>(w.data()), w.size() * sizeof w[0]);
    return {h.triangles.size(), static_cast<std::uint32_t>(crc)};
  }
};

/// The run itself, simulated or replayed.
traced trace(const run_options& o, const setup& s, const loaded_model& model, const std::vector<job_packet>& jobs,
             const std::optional<waveform_window>& window, const result_handler& handler) {
  traced t;
  t.speed.pace = run_pace_words[static_cast<std::size_t>(o.how)];
  const auto begin = wall_clock::now();
  if (o.how == run_pace::replay) {
    if (window) throw input_error("--vcd", "--pace replay, which has no signals", "--pace skipping, which is quick outside the window");
    t.figures = replay(s.unit, s.bench, model.octree.words, jobs, 2, handler);
  } else {
    simulation sim(s.unit, s.bench, model.view(), jobs, static_cast<pace>(o.how), window);
    if (handler) sim.board().on_result(handler);
    const progress bar(!o.quiet, jobs.size());
    sim.clock().set_progress([&] { bar.show(sim.board().figures().rays); });
    sim.run();
    t.figures = sim.figures();
    t.speed.clock = sim.clock().stats();
  }
  t.speed.run_seconds = seconds(wall_clock::now() - begin).count();
  t.speed.rays = jobs.size();
  t.speed.cycles = t.figures.results.last_result + 1;
  return t;
}

/// What a contact sheet says of the run.
picture_text text_of(const setup& s, const loaded_model& model, const traced& run) {
  const rtu_params& rtu = s.unit.rtu;
  const std::string name = std::filesystem::path(s.what.model.model).filename().string();
  const std::string size = model.triangles ? fmt::format("{} triangles", grouped(model.triangles->hierarchy.triangles.size()))
                                           : fmt::format("{} voxels an edge", model.voxels_an_edge());
  return {fmt::format("{}, {}", name, size),
          fmt::format("{} x {} pixels, {} rays traced by {} {} {} in {} cycles: {:.2f} ms at {} MHz", s.what.picture.width,
                      s.what.picture.height, grouped(run.speed.rays), rtu.cores, model.triangles ? "triangle" : "voxel",
                      rtu.cores == 1 ? "core" : "cores", grouped(run.speed.cycles),
                      static_cast<double>(run.speed.cycles) / rtu.clock_mhz / 1e3, rtu.clock_mhz)};
}

}  // namespace

void run(const run_options& o) {
  const auto start = wall_clock::now();
  setup s(o);
  std::vector<picture_kind> kinds;
  for (const auto& image : o.images) kinds.push_back(kind_of(image));
  const auto window = window_of(o);
  check_outputs(o);
  const picture_preparation pictures(!o.images.empty());

  const bool triangles = s.unit.has_triangles();
  const loaded_model model(s);
  std::vector<job_packet> jobs = o.jobs.empty() ? model.jobs(s, !o.images.empty()) : read_jobs(o.jobs);
  if (!o.save_jobs.empty()) write_jobs(o.save_jobs, jobs);
  const std::uint32_t jobs_crc = crc32_of(jobs.data(), jobs.size() * sizeof(job_packet));
  std::optional<frame> picture;
  std::optional<triangle_surfaces> surfaces;
  if (!o.images.empty()) {
    picture.emplace(s.what.picture, s.unit.fixed_point.fraction_bits, triangles);
    if (triangles) surfaces.emplace(*model.triangles, s.unit.quantisation_, s.unit.triangle_unit_.errata.t_halved ? 2 : 1);
    if (o.jobs.empty()) picture->leave_out_all_but(jobs);
  }
  std::optional<results_log> log;
  if (!o.log.empty()) log.emplace(o.log, triangles);

  const result_handler handler = [&](cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
    if (picture && surfaces)
      picture->store(r, latency_cycles, surfaces->at(jobs[r.sequence], r));
    else if (picture)
      picture->store(r, latency_cycles);
    if (log) log->add(c, r);
  };
  traced run = trace(o, s, model, jobs, window, picture || log ? handler : result_handler());
  if (picture && picture->strays() != 0)
    throw input_error(o.jobs.string(),
                      fmt::format("{} job ids beyond the frame of {} x {}", picture->strays(), picture->width(), picture->height()),
                      "frame.width and frame.height of the jobs, or no --image");

  if (log) log->commit();
  if (picture) {
    picture->set_way(run.figures.results.way_cycles());
    if (std::any_of(kinds.begin(), kinds.end(), shows_places)) picture->set_places(model.places(jobs, *picture));
    std::vector<job_packet>().swap(jobs);  // pictures need the room
    const picture_text text = text_of(s, model, run);
    for (std::size_t i = 0; i < kinds.size(); ++i) write_picture(o.images[i], *picture, kinds[i], text);
  }

  config::report statistics;
  run.figures.describe(statistics);
  run_record record;
  const auto [model_words, model_crc] = model.words();
  record.inputs = {{"scene", o.scene.string()},
                   {"architecture", o.architecture.string()},
                   {"model", s.what.model.model},
                   {triangles ? "model_triangles" : "model_words", model_words},
                   {"model_crc32", fmt::format("{:08x}", model_crc)},
                   {"jobs", o.jobs.string()},
                   {"jobs_crc32", fmt::format("{:08x}", jobs_crc)}};
  record.parameters = s.parameters.values();
  record.statistics = statistics.values();
  run.speed.all_seconds = seconds(wall_clock::now() - start).count();
  config::report simulator;
  run.speed.describe(simulator);
  record.simulator = simulator.values();
  if (!o.statistics.empty()) write_record(o.statistics, record);
  if (const auto c = run.figures.conversion(); c.overflows + c.nans != 0 && !(o.jobs.empty() && s.what.model.rays.empty()))
    fmt::print(stderr, "rtusim: warning: {} parameters of the jobs lie beyond the fixed-point range, {} are no number\n", c.overflows,
               c.nans);
  if (triangles && model.triangles->dropped + model.triangles->clamped != 0)
    fmt::print(stderr, "rtusim: warning: of the triangles {} lost their area on the grid, {} have edges beyond edge_shift and were clamped\n",
               model.triangles->dropped, model.triangles->clamped);
  if (!o.quiet) fmt::print("{}", summary_text(record));
}

}  // namespace rtusim
