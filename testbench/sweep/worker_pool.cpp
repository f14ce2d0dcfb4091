#include "testbench/sweep/worker_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/run/interrupts.h"

namespace rtusim {
namespace {

constexpr std::size_t most_reason_bytes = 4000;  // a pipe takes more at once

worker_report report_of(const std::function<worker_report()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return {worker_report::outcome::failed, "out of memory"};
  } catch (const std::exception& e) {
    return {worker_report::outcome::failed, e.what()};
  }
}

/// What a process said on a pipe until it closed it.
std::string rest_of(int pipe) {
  std::string text;
  std::array<char, 4096> chunk{};
  for (ssize_t n; (n = read(pipe, chunk.data(), chunk.size())) != 0;) {
    if (n > 0) text.append(chunk.data(), static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) break;
  }
  return text;
}

int end_of(pid_t process) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

}  // namespace

worker_pool::~worker_pool() {
  for (const auto& [pipe, w] : running_) kill(w.process, SIGKILL);
  for (const auto& [pipe, w] : running_) {
    end_of(w.process);
    close(pipe);
  }
}

void worker_pool::start(std::size_t number, const std::function<worker_report()>& work) {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw input_error("sweep", "no file more can be opened", "fewer workers: -j");
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    interrupts::leave_to_parent();
    if (getppid() != parent) _exit(1);
    const worker_report r = report_of(work);
    const std::string text = static_cast<char>(r.how) + r.reason.substr(0, most_reason_bytes);
    while (write(ends[1], text.data(), text.size()) < 0 && errno == EINTR) continue;
    _exit(0);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw input_error("sweep", "no process more can be started", "fewer workers: -j");
  }
  running_[ends[0]] = {child, number};
}

std::optional<worker_pool::ended> worker_pool::next(std::chrono::milliseconds patience) {
  std::vector<pollfd> waiting;
  for (const auto& [pipe, w] : running_) waiting.push_back({pipe, POLLIN, 0});
  if (poll(waiting.data(), waiting.size(), static_cast<int>(patience.count())) <= 0) return {};
  for (const pollfd& at : waiting) {
    if (at.revents == 0) continue;
    const worker w = running_.at(at.fd);
    const std::string said = rest_of(at.fd);
    running_.erase(at.fd);
    close(at.fd);
    const int status = end_of(w.process);
    if (WIFSIGNALED(status)) {
      const int number = WTERMSIG(status);
      return ended{w.work,
                   {worker_report::outcome::failed, fmt::format("the worker was ended by signal {} ({})", number, strsignal(number))}};
    }
    if (said.empty()) return ended{w.work, {worker_report::outcome::failed, "the worker ended without a report"}};
    return ended{w.work, {static_cast<worker_report::outcome>(said[0]), said.substr(1)}};
  }
  return {};
}

}  // namespace rtusim
