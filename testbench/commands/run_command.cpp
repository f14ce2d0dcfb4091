#include "testbench/commands/run_command.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "testbench/commands/options.h"
#include "testbench/pictures/pictures.h"
#include "testbench/run/job_file.h"
#include "testbench/run/procedure.h"
#include "testbench/run/progress_line.h"
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
  run_inputs inputs(s, o.jobs, 2, !o.images.empty());
  const picture_preparation pictures(!o.images.empty());
  config::check_apart(outputs, read.names());  // a mesh may have more files than one
  std::vector<job_packet>& jobs = inputs.sent.packets;
  if (window && o.how != run_pace::replay && !o.waveform_all) check_size(*window, s, *inputs.model, jobs);
  if (!o.save_jobs.empty()) write_jobs(o.save_jobs, jobs);
  inputs.record["scene"] = o.scene.string();
  inputs.record["architecture"] = o.architecture.string();
  inputs.record["jobs"] = o.jobs.string();
  std::optional<run_pictures> shown;
  if (!o.images.empty()) shown.emplace(s, *inputs.model, jobs, o.jobs.empty());
  std::optional<results_log> log;
  if (!o.log.empty()) log.emplace(o.log, *inputs.model);

  run_manner manner{o.how, window, {}, {}, 2};
  if (shown || log)
    manner.each = [&](cycle c, const traversal_result& r, std::uint64_t latency_cycles) {
      if (shown) shown->store(r, latency_cycles);
      if (log) log->add(c, r);
    };
  traced_run run = [&] {
    const progress_line line(!o.quiet);
    manner.progress = [&](std::uint64_t rays) { line.show(fmt::format("{:3} % of {} rays", 100 * rays / jobs.size(), jobs.size())); };
    return trace(s, inputs, manner);
  }();
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

  run.speed.all_seconds = seconds(wall_clock::now() - start).count();
  const run_record record = record_of(s, inputs, run);
  if (!o.statistics.empty()) write_record(o.statistics, record);
  for (const std::string& warning : run.figures.warnings()) fmt::print(stderr, "rtusim: warning: {}\n", warning);
  if (!o.quiet) fmt::print(config::stream_beside(outputs), "{}", summary_text(record));
}

namespace {

/// Adds the option for how a run comes by its cycles.
void add_pace(CLI::App& app, run_pace& to) {
  const auto read = [&to](const std::string& word) {
    const auto found = std::find(std::begin(run_pace_words), std::end(run_pace_words), word);
    if (found == std::end(run_pace_words)) throw input_error("--pace", '"' + word + '"', "skipping, stepped, checked or replay");
    to = static_cast<run_pace>(found - std::begin(run_pace_words));
  };
  app.add_option_function<std::string>("--pace", read, "skipping, stepped, checked or replay")->type_name("PACE");
}

}  // namespace

void add_run(CLI::App& program) {
  auto options = std::make_shared<run_options>();
  run_options& o = *options;
  CLI::App& app = add_command(program, "run", "trace a scene with a design", options, run);
  app.add_option("SCENE.toml", o.scene, "what is traced")->type_name("");
  app.add_option("--arch", o.architecture, "the design, a TOML file")->type_name("FILE");
  app.add_option("--set", o.assignments, "a parameter, see 'rtusim explain'; KEY=default takes back what a file gives")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("--model", o.model, "an octree (.svo), voxels (.binvox) or a mesh in place of the scene's")->type_name("FILE");
  app.add_option("--jobs", o.jobs, "rays as job packets in place of the camera's")->type_name("FILE");
  app.add_option("--save-jobs", o.save_jobs, "keep the job packets")->type_name("FILE");
  add_pace(app, o.how);
  app.add_option(
         "--image", o.images,
         fmt::format("a picture: OUT.sheet.png has all maps with legends; OUT.png is shaded; OUT.KIND.png with KIND {}; OUT.exr has all as "
                     "float layers; may be repeated",
                     picture_words()))
      ->type_name("FILE")
      ->allow_extra_args(false);
  app.add_option("--stats", o.statistics, "all figures, JSON")->type_name("FILE");
  app.add_option("--log", o.log, "a line for each result, CSV")->type_name("FILE");
  app.add_option("--vcd", o.waveform, "a waveform")->type_name("FILE");
  add_number(app, "--vcd-from", o.waveform_from, "CYCLE", "its first cycle");
  add_number(app, "--vcd-to", o.waveform_to, "CYCLE", "its last cycle");
  add_number(app, "--vcd-job", o.waveform_job, "ID", "or the id of the job that it follows");
  app.add_flag("--vcd-all", o.waveform_all, "a waveform however large: of more than 500 MB it is refused without this");
  app.add_flag("--quiet", o.quiet, "no summary");
  app.footer("Example: rtusim run scenes/dragon.toml --arch testbench/architectures/espe2019.toml --set rtu.cores=8 --image dragon.png");
}

}  // namespace rtusim
