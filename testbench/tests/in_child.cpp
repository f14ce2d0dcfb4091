#include "testbench/tests/in_child.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

namespace rtusim {

std::string in_child(const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return "error: no pipe";
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    std::string result;
    try {
      result = work();
    } catch (const std::exception& e) {
      result = std::string("error: ") + e.what();
    }
    for (std::size_t sent = 0; sent < result.size();) {
      const ssize_t n = write(ends[1], result.data() + sent, result.size() - sent);
      if (n <= 0) break;
      sent += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(ends[1]);
  std::string result;
  char buffer[1 << 14];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;) result.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) return "error: the child ended with status " + std::to_string(status) + " behind " + result;
  return result;
}

}  // namespace rtusim
