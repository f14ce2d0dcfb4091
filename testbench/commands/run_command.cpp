#include "testbench/commands/run_command.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "testbench/bench/simulation.h"
#include "testbench/pictures/pictures.h"
#include "testbench/replay/replay.h"
#include "testbench/run/job_file.h"
#include "testbench/run/results_log.h"
#include "testbench/run/run_pictures.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"
#include "testbench/run/waveform_size.h"

namespace rtusim {
namespace {

using seconds = std::chrono::duration<double>;
using wall_clock = std::chrono::steady_clock;

std::optional<waveform_window> window_of(const run_options& o) {
  if (o.waveform.empty()) {
    if (o.waveform_from || o.waveform_to || o.waveform_job || o.waveform_all)
      throw input_error("--vcd-from, --vcd-to, --vcd-job, --vcd-all", "no --vcd", "--vcd OUT.vcd with it");
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

std::vector<std::filesystem::path> outputs_of(const run_options& o) {
  std::vector<std::filesystem::path> outputs{o.save_jobs, o.statistics, o.log, o.waveform};
  outputs.insert(outputs.end(), o.images.begin(), o.images.end());
  return outputs;
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

/// The run itself, simulated or replayed.
traced trace(const run_options& o, const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs,
             const std::optional<waveform_window>& window, const result_handler& handler) {
  traced t;
  t.speed.pace = run_pace_words[static_cast<std::size_t>(o.how)];
  const auto begin = wall_clock::now();
  if (o.how == run_pace::replay) {
    if (window) throw input_error("--vcd", "--pace replay, which has no signals", "--pace skipping, which is quick outside the window");
    t.figures = replay(s.unit, s.bench, model.octree(), jobs, 2, handler);
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
  t.speed.cycles = t.figures.results.total_cycles();
  return t;
}

}  // namespace

void run(const run_options& o) {
  const auto start = wall_clock::now();
  run_setup s({o.scene, o.architecture, o.assignments, o.model});
  if (!s.what.model.rays.empty() && !o.jobs.empty()) throw input_error("--jobs", "with scene.rays", "one or the other");
  std::vector<picture_kind> kinds;
  for (const auto& image : o.images) kinds.push_back(kind_of(image));
  const auto window = window_of(o);
  const auto outputs = outputs_of(o);
  config::check_writable_apart(outputs, {o.scene, o.architecture, s.what.model.model, s.what.model.rays, o.jobs});

  const config::input_ledger read;
  const loaded_model model(s);
  const picture_preparation pictures(!o.images.empty());
  model.settle(s);
  sent_jobs sent = o.jobs.empty() ? model.jobs(s, 2, !o.images.empty()) : model.jobs(read_jobs(o.jobs));
  std::vector<job_packet>& jobs = sent.packets;
  config::check_apart(outputs, read.names());  // a mesh may have more files than one
  if (window && o.how != run_pace::replay && !o.waveform_all) check_size(*window, s, model, jobs);
  if (!o.save_jobs.empty()) write_jobs(o.save_jobs, jobs);
  run_record record;
  record.inputs = inputs_of(s, model, jobs);
  record.inputs["scene"] = o.scene.string();
  record.inputs["architecture"] = o.architecture.string();
  record.inputs["jobs"] = o.jobs.string();
  std::optional<run_pictures> shown;
  if (!o.images.empty()) shown.emplace(s, model, jobs, o.jobs.empty());
  std::optional<results_log> log;
  if (!o.log.empty()) log.emplace(o.log, model.triangles() ? &*model.triangles() : nullptr);

  const result_handler handler = [&](cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
    if (shown) shown->store(r, latency_cycles);
    if (log) log->add(c, r);
  };
  traced run = trace(o, s, model, jobs, window, shown || log ? handler : result_handler());
  run.figures.host = sent.host;
  if (shown && shown->picture().strays() != 0)
    throw input_error(o.jobs.string(),
                      fmt::format("{} job ids beyond the frame of {} x {}", shown->picture().strays(), shown->picture().width(),
                                  shown->picture().height()),
                      "frame.width and frame.height of the jobs, or no --image");

  if (log) log->commit();
  if (shown) {
    shown->finish(run.figures, std::any_of(kinds.begin(), kinds.end(), shows_places));
    std::vector<job_packet>().swap(jobs);  // pictures need the room
    for (const auto& image : o.images) shown->write(image);
  }

  config::report statistics;
  run.figures.describe(statistics);
  record.parameters = s.parameters.values();
  record.statistics = statistics.values();
  run.speed.all_seconds = seconds(wall_clock::now() - start).count();
  config::report simulator;
  run.speed.describe(simulator);
  record.simulator = simulator.values();
  if (!o.statistics.empty()) write_record(o.statistics, record);
  for (const std::string& warning : run.figures.warnings()) fmt::print(stderr, "rtusim: warning: {}\n", warning);
  if (!o.quiet) fmt::print(config::stream_beside(outputs), "{}", summary_text(record));
}

}  // namespace rtusim
