#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <systemc>

#include "modules/config/error.h"
#include "testbench/explain_command.h"
#include "testbench/info_command.h"
#include "testbench/run_command.h"
#include "testbench/unit_bench.h"

namespace {

using namespace rtusim;

constexpr int done = 0;
constexpr int simulation_failed = 1;
constexpr int bad_input = 2;

/// An error of the user's or of the model's is one line.
int report(const std::exception& e, int status) {
  std::string text = e.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  fmt::print(stderr, "rtusim: {}\n", text);
  return status;
}

/// Adds what `run` takes to its command.
void add_run(CLI::App& app, run_options& o) {
  static const std::map<std::string, pace> paces{{"skipping", pace::skipping}, {"stepped", pace::stepped}, {"checked", pace::checked}};
  app.add_option("SCENE.toml", o.scene, "what is traced");
  app.add_option("--arch", o.architecture, "the design, a TOML file");
  app.add_option("--set", o.assignments, "a parameter, KEY=VALUE; see 'rtusim explain'")->allow_extra_args(false);
  app.add_option("--model", o.model, "an octree (.svo) or a mesh in place of the scene's");
  app.add_option("--jobs", o.jobs, "rays as job packets in place of the camera's");
  app.add_option("--save-jobs", o.save_jobs, "keep the job packets");
  app.add_option("--pace", o.how, "skipping, stepped or checked")->transform(CLI::CheckedTransformer(paces));
  app.add_option("--image", o.images, "OUT.png, OUT.cost.png, OUT.depth.png or OUT.exr; may be repeated")->allow_extra_args(false);
  app.add_option("--stats", o.statistics, "all figures, JSON");
  app.add_option("--log", o.log, "a line for each result, CSV");
  app.add_option("--vcd", o.waveform, "a waveform");
  app.add_option("--vcd-from", o.waveform_from, "its first cycle");
  app.add_option("--vcd-to", o.waveform_to, "its last cycle");
  app.add_option("--vcd-job", o.waveform_job, "or the id of the job that it follows");
  app.add_flag("--quiet", o.quiet, "no summary");
}

int command_line(int argc, char** argv) {
  CLI::App app("rtusim simulates ray tracing hardware to the bit and to the clock cycle", "rtusim");
  app.require_subcommand(1);

  run_options run_asked;
  auto* const run_app = app.add_subcommand("run", "trace a scene with a design");
  add_run(*run_app, run_asked);

  unit_request unit_asked;
  auto* const unit_app = app.add_subcommand("unit", "one unit alone on raw words");
  unit_app->add_option("NAME", unit_asked.name, "svo_core or float_to_fixed")->required();
  unit_app->add_option("--jobs", unit_asked.files.jobs, "input columns, CSV")->required();
  unit_app->add_option("--out", unit_asked.files.out, "the same columns with the outputs, CSV")->required();
  unit_app->add_option("--model", unit_asked.files.model, "svo_core: the octree in its memory");
  unit_app->add_option("--arch", unit_asked.architecture, "the design, a TOML file");
  unit_app->add_option("--set", unit_asked.assignments, "a parameter, KEY=VALUE")->allow_extra_args(false);

  std::string info_file;
  auto* const info_app = app.add_subcommand("info", "describe an octree or a mesh");
  info_app->add_option("FILE", info_file)->required();

  std::string key;
  auto* const explain_app = app.add_subcommand("explain", "every parameter and statistic: unit, range, meaning");
  explain_app->add_option("KEY", key, "only what begins so");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    return report(std::runtime_error(std::string(e.what()) + "; see rtusim --help"), bad_input);
  }
  if (*run_app) run(run_asked);
  if (*unit_app) bench_unit(unit_asked);
  if (*info_app) fmt::print("{}", info_text(info_file));
  if (*explain_app) fmt::print("{}", explain_text(key));
  return done;
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  try {
    return command_line(argc, argv);
  } catch (const input_error& e) {
    return report(e, bad_input);
  } catch (const std::bad_alloc&) {
    return report(std::runtime_error("out of memory"), bad_input);
  } catch (const std::exception& e) {
    return report(e, simulation_failed);
  }
}

int main(int argc, char* argv[]) {
  // SystemC's banner would go before every output.
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
