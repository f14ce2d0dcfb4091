#include "testbench/run/procedure.h"

#include <chrono>
#include <utility>
#include <vector>

#include "modules/config/error.h"
#include "testbench/kinds/checksum.h"
#include "testbench/run/job_file.h"

namespace rtusim {
namespace {

using wall_clock = std::chrono::steady_clock;

nlohmann::ordered_json inputs_of(const run_setup& s, const loaded_model& model, const std::vector<job_packet>& jobs) {
  nlohmann::ordered_json inputs{{"scene", ""}, {"architecture", ""}, {"model", s.what.model.model}};
  model.describe(inputs);
  inputs["jobs"] = "";
  inputs["jobs_crc32"] = checksum()(jobs).text();
  return inputs;
}

sent_jobs jobs_of(const run_setup& s, const loaded_model& model, const std::filesystem::path& file, unsigned threads, bool pictured) {
  return file.empty() ? model.jobs(s.hardware, s.what, threads, pictured) : model.jobs(read_jobs(file));
}

}  // namespace

run_pace quickest_pace(const run_setup& s) { return replay_obstacle(s.hardware, s.bench).empty() ? run_pace::replay : run_pace::skipping; }

run_inputs::run_inputs(run_setup& s, const std::filesystem::path& job_file, unsigned threads, bool pictured)
    : model(s.host().load(s.hardware, s.what)) {
  model->settle(s.hardware);
  sent = jobs_of(s, *model, job_file, threads, pictured);
  record = inputs_of(s, *model, sent.packets);
}

void run_inputs::walk(const run_setup& s, unsigned threads) {
  if (quickest_pace(s) != run_pace::replay) return;
  walker = model->walker(s.hardware);
  walked = walk_rays(*walker, sent.packets, threads);
}

traced_run trace(const run_setup& s, const run_inputs& inputs, const run_manner& manner) {
  const std::vector<job_packet>& jobs = inputs.sent.packets;
  traced_run run;
  run.speed.pace = run_pace_words[static_cast<std::size_t>(manner.pace)];
  const auto begin = wall_clock::now();
  if (manner.pace == run_pace::replay) {
    if (manner.window)
      throw input_error("--vcd", "--pace replay, which has no signals", "--pace skipping, which is quick outside the window");
    check_replayable(s.hardware, s.bench);
    run.figures = inputs.walked ? replay(s.hardware, s.bench, *inputs.walker, *inputs.walked, manner.each)
                                : replay(s.hardware, s.bench, *inputs.model->walker(s.hardware), jobs, manner.threads, manner.each);
    run.speed.followed = run.figures.followed;
  } else {
    simulation sim(s.hardware, s.bench, inputs.model->memories(), jobs, static_cast<pace>(manner.pace), manner.window);
    if (manner.each) sim.board().on_result(manner.each);
    if (manner.progress) sim.clock().set_progress([&] { manner.progress(sim.board().figures().rays); });
    sim.run();
    run.figures = sim.figures();
    run.speed.clock = sim.clock().stats();
  }
  run.figures.host = inputs.sent.host;
  run.speed.run_seconds = std::chrono::duration<double>(wall_clock::now() - begin).count();
  run.speed.rays = jobs.size();
  run.speed.cycles = run.figures.results.total_cycles();
  return run;
}

run_record record_of(const run_setup& s, const run_inputs& inputs, const traced_run& run) {
  run_record record;
  record.inputs = inputs.record;
  record.inputs["model"] = s.what.model.model;
  record.parameters = s.parameters.values();
  config::report statistics({}, config::report::wants::values), simulator({}, config::report::wants::values);
  run.figures.describe(statistics);
  run.speed.describe(simulator);
  record.statistics = std::move(statistics).values();
  record.simulator = std::move(simulator).values();
  return record;
}

}  // namespace rtusim
