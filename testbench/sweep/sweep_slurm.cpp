#include "testbench/sweep/sweep_slurm.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/run/interrupts.h"

namespace rtusim {
namespace {

namespace fs = std::filesystem;

constexpr int no_program = 127;

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string script_text(const fs::path& sweep_file, const fs::path& folder, std::size_t tasks) {
  const fs::path program = fs::read_symlink("/proc/self/exe");
  // In full, so that no name is taken for an option.
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=rtusim-sweep\n"
      "#SBATCH --array=0-{}\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --output=/dev/null\n"
      "exec {} sweep {} --out {} --share \"$SLURM_ARRAY_TASK_ID/{}\" --quiet >{}/slurm-\"$SLURM_ARRAY_TASK_ID\".log 2>&1\n",
      tasks - 1, shell_quoted(program.string()), shell_quoted(fs::absolute(sweep_file).string()), shell_quoted(folder.string()), tasks,
      shell_quoted(folder.string()));
}

/// Its exit status; -1 when a signal ended it.
int wait_for(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR)
    if (interrupts::came()) kill(process, SIGTERM);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void run_slurm_array(const std::filesystem::path& sweep_file, const results_folder& folder, std::size_t tasks) {
  const fs::path here = fs::absolute(folder.path());
  const fs::path script = here / "slurm.sh", log = here / "slurm.log";
  folder.put({{"slurm.sh", script_text(sweep_file, here, tasks)}});
  std::error_code ignored;
  fs::remove(log, ignored);
  const pid_t child = fork();
  if (child < 0) throw input_error("--engine slurm", "no process more can be started", "fewer processes");
  if (child == 0) {
    const int to = open(log.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW, 0666);
    dup2(to, STDOUT_FILENO);
    dup2(to, STDERR_FILENO);
    execlp("sbatch", "sbatch", "--wait", script.c_str(), static_cast<char*>(nullptr));
    _exit(no_program);
  }
  const int status = wait_for(child);
  if (status == no_program)
    throw input_error("--engine slurm", "no sbatch on PATH",
                      fmt::format("Slurm, or {} submitted where there is one", (folder.path() / "slurm.sh").string()));
  std::ifstream in(log, std::ios::binary);
  std::string said{std::istreambuf_iterator<char>(in), {}};
  said.erase(said.find_last_not_of('\n') + 1);
  if (interrupts::came()) throw simulation_error("sweep: interrupted; the array goes on (" + said + "), and the same command gathers it");
  // Tasks whose points fail, and those that are cancelled, end with an error, too; those points are rows with their reasons.
  if (status != 0 && said.find("Submitted batch job") == std::string::npos) throw input_error("sbatch", said, "a Slurm that takes jobs");
}

}  // namespace rtusim
