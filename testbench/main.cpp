#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <systemc>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/printable.h"
#include "modules/config/schema.h"
#include "modules/config/temporary.h"
#include "testbench/commands/convert_command.h"
#include "testbench/commands/explain_command.h"
#include "testbench/commands/info_command.h"
#include "testbench/commands/record_command.h"
#include "testbench/commands/run_command.h"
#include "testbench/commands/sweep_command.h"
#include "testbench/commands/unit_command.h"
#include "testbench/pictures/pictures.h"
#include "testbench/run/program_version.h"

namespace {

using namespace rtusim;

constexpr int done = 0;
constexpr int simulation_failed = 1;
constexpr int bad_input = 2;

/// An error of the user's or of the model's is one line, also when there is no memory left.
int report(std::string_view text, int status) noexcept {
  constexpr std::string_view program = "rtusim: ";
  static char line[1 << 13];
  const std::size_t room = sizeof line - program.size() - 1;
  char* end = std::copy(program.begin(), program.end(), line);
  end = std::copy_n(text.begin(), std::min(text.size(), room), end);
  config::make_printable(line, static_cast<std::size_t>(end - line));
  *end++ = '\n';
  for (const char* from = line; from != end;) {
    const ssize_t n = ::write(STDERR_FILENO, from, static_cast<std::size_t>(end - from));
    if (n < 0 && errno != EINTR) break;
    from += std::max<ssize_t>(n, 0);
  }
  return status;
}

/// Nobody reads standard output any more: the process ends as other programs do then, without a word, unless its parent ignores that.
int end_with_pipe(const std::system_error& e) {
  struct sigaction action {};
  ::sigaction(SIGPIPE, nullptr, &action);
  if (action.sa_handler != SIG_IGN) {
    config::remove_temporaries();
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  return report(e.what(), bad_input);
}

/// Calls `work`, which gives the exit status; what it throws is told in one line.
template <class Work>
int told(Work&& work) {
  try {
    return work();
  } catch (const input_error& e) {
    return report(e.what(), bad_input);
  } catch (const std::bad_alloc&) {
    return report("out of memory", bad_input);
  } catch (const std::system_error& e) {  // standard output on a full disk, no more threads
    if (e.code() == std::errc::broken_pipe) return end_with_pipe(e);
    if (e.code() == std::errc::not_enough_memory) return report("out of memory", bad_input);
    return report(e.what(), bad_input);
  } catch (const std::exception& e) {
    return report(e.what(), simulation_failed);
  }
}

/// An exception that came where none may pass, as a lack of memory can.
[[noreturn]] void end_at_once() {
  config::remove_temporaries();
  const std::exception_ptr error = std::current_exception();
  std::_Exit(error ? told([&error]() -> int { std::rethrow_exception(error); }) : simulation_failed);
}

/// Sees that files which are opened later don't take the number of a standard stream that is closed. What is written to standard output
/// fails then, and is told.
void open_standard_streams() {
  const std::pair<int, int> streams[] = {{STDIN_FILENO, O_RDONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}};
  for (const auto& [number, flags] : streams)
    if (::fcntl(number, F_GETFD) < 0 && ::open("/dev/null", flags) != number) std::_Exit(bad_input);
}

/// Sees that all that was printed came to standard output.
void finish_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::system_error(errno, std::generic_category(), "standard output");
}

/// An option that takes a whole number, in digits alone: CLI11 would wrap -3 and cut what is too large.
template <class Number>
void add_number(CLI::App& app, const std::string& name, std::optional<Number>& to, const char* kind, const std::string& meaning) {
  const auto read = [name, &to](const std::string& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      throw input_error(name, '"' + text + '"', fmt::format("a whole number from 0 to {}", std::numeric_limits<Number>::max()));
    to = value;
  };
  app.add_option_function<std::string>(name, read, meaning)->type_name(kind);
}

/// Adds the option for how a run comes by its cycles.
void add_pace(CLI::App& app, run_pace& to) {
  const auto read = [&to](const std::string& word) {
    const auto found = std::find(std::begin(run_pace_words), std::end(run_pace_words), word);
    if (found == std::end(run_pace_words)) throw input_error("--pace", '"' + word + '"', "skipping, stepped, checked or replay");
    to = static_cast<run_pace>(found - std::begin(run_pace_words));
  };
  app.add_option_function<std::string>("--pace", read, "skipping, stepped, checked or replay")->type_name("PACE");
}

/// Adds what `run` takes to its command.
void add_run(CLI::App& app, run_options& o) {
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

/// Adds what `sweep` takes to its command.
void add_sweep(CLI::App& app, sweep_options& o) {
  app.add_option("SWEEP.toml", o.file, "axes, scenes and what is kept; see testbench/sweeps")->required()->type_name("");
  app.add_option("--out", o.out, "folder of the results; out/SWEEP if left out")->type_name("DIR");
  const auto read_jobs = [&o](const std::string& text) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), o.jobs);
    if (error != std::errc{} || end != text.data() + text.size() || o.jobs < 1 || o.jobs > 4096)
      throw input_error("-j", '"' + text + '"', "a whole number from 1 to 4096");
  };
  app.add_option_function<std::string>("-j", read_jobs, "worker processes, or tasks of the Slurm array")->type_name("N");
  const auto read_engine = [&o](const std::string& word) {
    if (word != "local" && word != "slurm") throw input_error("--engine", '"' + word + '"', "local or slurm");
    o.how = word == "slurm" ? sweep_options::engine::slurm : sweep_options::engine::local;
  };
  app.add_option_function<std::string>("--engine", read_engine, "local processes, or a job array of Slurm")->type_name("ENGINE");
  app.add_option("--share", o.share, "only the points with number modulo N = I, and no table: for one of N machines")->type_name("I/N");
  app.add_flag("--retry-failed", o.retry_failed, "run again what failed before");
  app.add_flag("--units", o.units, "a second header row in results.csv: the columns' units");
  app.add_flag("--quiet", o.quiet, "no summary");
  app.footer("What is done stays: an interrupted sweep goes on with the same command, a changed one runs only what is new.");
}

/// Adds what `convert` takes to its command.
void add_convert(CLI::App& app, convert_options& o) {
  app.add_option("FROM", o.from, "a mesh, voxels (.binvox) or an octree (.svo)")->required()->type_name("");
  app.add_option("TO", o.to, "OUT.svo or OUT.binvox")->required()->type_name("");
  add_number(app, "--resolution", o.resolution, "N", "voxels an edge, a power of two up to 1024");
  app.add_flag("--solid", o.solid, "the inside, too, of a closed mesh");
  app.add_option("--up", o.up, "what points up in the mesh: x, y (usual), z, -x, -y or -z")->type_name("AXIS");
  add_number(app, "--margin", o.margin, "M", "voxels left free at each face of the cube (0)");
  const auto read_fit = [&o](const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      throw input_error("--fit", '"' + text + '"', "a number above 0, at most 1");
    o.fit = value;
  };
  app.add_option_function<std::string>("--fit", read_fit, "share of the rest that the mesh's longest edge takes (0.98)")->type_name("F");
  app.add_flag("--quiet", o.quiet, "no summary");
  app.footer("Example: rtusim convert scenes/data/bunny.obj bunny.svo --resolution 128 --solid");
}

/// What is wrong with a command line, as far as CLI11 reads it: with the command, and the word that may have been meant.
input_error usage_error(const CLI::App& app, const CLI::ParseError& e) {
  const auto given = app.get_subcommands();
  const auto unknown = app.remaining(true);
  std::vector<std::string> words;
  if (given.empty()) {
    for (const CLI::App* c : app.get_subcommands({})) words.push_back(c->get_name());
    return {"command", unknown.empty() ? "none" : '"' + unknown.front() + '"', fmt::format("one of {}", fmt::join(words, ", "))};
  }
  const CLI::App& command = *given.front();
  const std::string help = fmt::format("what 'rtusim {} --help' lists", command.get_name());
  if (unknown.empty()) return {command.get_name(), e.what(), help};
  for (const CLI::Option* o : command.get_options()) words.push_back(o->get_name());
  const std::string near = config::nearest(unknown.front(), words);
  return {command.get_name(), "unknown argument \"" + unknown.front() + '"', near.empty() ? help : near};
}

int command_line(int argc, char** argv) {
  CLI::App app("rtusim simulates ray tracing hardware to the bit and to the clock cycle", "rtusim");
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("rtusim {}", program_version()), "the version, and the commit of the sources");
  app.footer("'rtusim COMMAND --help' tells what a command takes, 'rtusim explain' every parameter of a design.");

  run_options run_asked;
  auto* const run_app = app.add_subcommand("run", "trace a scene with a design");
  add_run(*run_app, run_asked);

  unit_request unit_asked;
  auto* const unit_app = app.add_subcommand("unit", "one unit alone on raw words");
  unit_app->add_option("NAME", unit_asked.name, lone_unit_words())->required()->type_name("");
  unit_app->add_option("--jobs", unit_asked.files.jobs, "input columns, CSV")->required()->type_name("FILE");
  unit_app->add_option("--out", unit_asked.files.out, "the same columns with the outputs, CSV")->required()->type_name("FILE");
  unit_app->add_option("--model", unit_asked.files.model, "svo_core: the octree in its memory")->type_name("FILE");
  unit_app->add_option("--memory", unit_asked.files.memory, "bih_core: the folder of its memories")->type_name("DIR");
  unit_app->add_option("--arch", unit_asked.architecture, "the design, a TOML file")->type_name("FILE");
  unit_app->add_option("--set", unit_asked.assignments, "a parameter; see 'rtusim explain'")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);

  sweep_options sweep_asked;
  auto* const sweep_app = app.add_subcommand("sweep", "run a hundred designs, and one table of them all");
  add_sweep(*sweep_app, sweep_asked);

  rerun_options rerun_asked;
  auto* const rerun_app = app.add_subcommand("rerun", "run what a statistics file records once more: the figures must be the same");
  rerun_app->add_option("STATS.json", rerun_asked.record, "a statistics file")->required()->type_name("");
  rerun_app->add_option("--stats", rerun_asked.statistics, "the new statistics file")->type_name("FILE");
  rerun_app->add_flag("--quiet", rerun_asked.quiet, "no word when they are");

  std::string diff_a, diff_b;
  auto* const diff_app = app.add_subcommand("diff", "what differs between two statistics files, in design and in result");
  diff_app->add_option("A.json", diff_a, "a statistics file")->required()->type_name("");
  diff_app->add_option("B.json", diff_b, "another")->required()->type_name("");

  convert_options convert_asked;
  auto* const convert_app = app.add_subcommand("convert", "make an octree or voxels of a mesh, or one of the other");
  add_convert(*convert_app, convert_asked);

  std::string info_file, info_image;
  auto* const info_app = app.add_subcommand("info", "describe an octree, voxels or a mesh");
  info_app->add_option("FILE", info_file, "an octree (.svo), voxels (.binvox) or a mesh")->required()->type_name("");
  info_app->add_option("--image", info_image, "OUT.png: three slices through the middle, and a view")->type_name("FILE");

  std::string key;
  auto* const explain_app = app.add_subcommand("explain", "every parameter and statistic: unit, range, meaning");
  explain_app->add_option("KEY", key, "only what begins so")->type_name("");

  // An empty name is a variable of a script that is not set.
  const auto not_empty = [](const std::string& value) { return value.empty() ? "an empty value" : ""; };
  for (CLI::App* command : app.get_subcommands({}))
    for (CLI::Option* o : command->get_options()) o->check(not_empty);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      app.exit(e);
      finish_standard_output();
      return done;
    }
    throw usage_error(app, e);
  }
  if (*run_app) run(run_asked);
  if (*unit_app) bench_unit(unit_asked);
  if (*sweep_app) sweep(sweep_asked);
  if (*rerun_app) rerun(rerun_asked);
  if (*diff_app) {
    const std::string text = difference_text(diff_a, diff_b);
    fmt::print("{}", text.empty() ? "no difference\n" : text);
  }
  if (*convert_app) {
    const std::string text = convert(convert_asked);
    if (!convert_asked.quiet) fmt::print(config::stream_beside({convert_asked.to}), "{}", text);
  }
  if (*info_app) fmt::print(config::stream_beside({info_image}), "{}", info_text(info_file, info_image));
  if (*explain_app) fmt::print("{}", explain_text(key));
  finish_standard_output();
  return done;
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  return told([&] { return command_line(argc, argv); });
}

int main(int argc, char* argv[]) {
  open_standard_streams();
  config::remove_temporaries_on_signals();
  std::set_terminate(end_at_once);
  // SystemC's banner would go before every output.
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
