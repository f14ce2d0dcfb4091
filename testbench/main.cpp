#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
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

/// The commands, in the order of the help.
constexpr void (*commands[])(CLI::App&) = {add_run, add_unit, add_sweep, add_rerun, add_diff, add_convert, add_info, add_explain};

int command_line(int argc, char** argv) {
  CLI::App app("rtusim simulates ray tracing hardware to the bit and to the clock cycle", "rtusim");
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("rtusim {}", program_version()), "the version, and the commit of the sources");
  app.footer("'rtusim COMMAND --help' tells what a command takes, 'rtusim explain' every parameter of a design.");

  for (const auto add : commands) add(app);

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
