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
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/run/interrupts.h"

namespace rtusim {
namespace {

// A report on a pipe: its length in two bytes, the outcome, the reason.
constexpr std::size_t length_bytes = 2, most_reason_bytes = 4000;

worker_report report_of(const std::function<worker_report(std::size_t)>& work, std::size_t number) {
  try {
    return work(number);
  } catch (const std::bad_alloc&) {
    return {worker_report::outcome::failed, "out of memory"};
  } catch (const std::exception& e) {
    return {worker_report::outcome::failed, e.what()};
  }
}

bool send(int pipe, const worker_report& r) {
  const std::string reason = r.reason.substr(0, most_reason_bytes);
  const std::size_t length = 1 + reason.size();
  const std::string text = std::string{static_cast<char>(length % 256), static_cast<char>(length / 256), static_cast<char>(r.how)} + reason;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = write(pipe, text.data() + sent, text.size() - sent);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) sent += static_cast<std::size_t>(n);
  }
  return true;
}

/// The first whole report of what was said, which it is taken from.
std::optional<worker_report> taken_from(std::string& said) {
  if (said.size() < length_bytes) return {};
  const std::size_t length = static_cast<unsigned char>(said[0]) + 256u * static_cast<unsigned char>(said[1]);
  if (said.size() < length_bytes + length) return {};
  worker_report r{static_cast<worker_report::outcome>(said[length_bytes]), said.substr(length_bytes + 1, length - 1)};
  said.erase(0, length_bytes + length);
  return r;
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

void worker_pool::start(std::vector<std::size_t> numbers, const std::function<worker_report(std::size_t)>& work) {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw input_error("sweep", "no file more can be opened", "fewer workers: -j");
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    interrupts::leave_to_parent();
    if (getppid() != parent) _exit(1);
    for (const std::size_t number : numbers)
      if (!send(ends[1], report_of(work, number))) _exit(1);
    _exit(0);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw input_error("sweep", "no process more can be started", "fewer workers: -j");
  }
  running_[ends[0]] = {child, std::move(numbers), 0, {}};
}

std::optional<worker_pool::ended> worker_pool::next(std::chrono::milliseconds patience) {
  if (ended_.empty()) {
    std::vector<pollfd> waiting;
    for (const auto& [pipe, w] : running_) waiting.push_back({pipe, POLLIN, 0});
    if (poll(waiting.data(), waiting.size(), static_cast<int>(patience.count())) <= 0) return {};
    for (const pollfd& at : waiting)
      if (at.revents != 0) hear(at.fd);
  }
  if (ended_.empty()) return {};
  ended first = std::move(ended_.front());
  ended_.pop_front();
  return first;
}

void worker_pool::hear(int pipe) {
  worker& w = running_.at(pipe);
  std::array<char, 4096> chunk{};
  const ssize_t n = read(pipe, chunk.data(), chunk.size());
  if (n < 0 && errno == EINTR) return;
  if (n > 0) w.said.append(chunk.data(), static_cast<std::size_t>(n));
  while (auto report = taken_from(w.said)) ended_.push_back({w.work[w.told++], std::move(*report)});
  if (n <= 0 || w.told == w.work.size()) bury(pipe);
}

void worker_pool::bury(int pipe) {
  const worker w = std::move(running_.at(pipe));
  running_.erase(pipe);
  close(pipe);
  const int status = end_of(w.process);
  if (w.told == w.work.size()) return;
  const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  const std::string reason = number != 0 ? fmt::format("the worker was ended by signal {} ({})", number, strsignal(number))
                                         : std::string("the worker ended without a report");
  ended_.push_back({w.work[w.told], {worker_report::outcome::failed, reason}});
  for (std::size_t i = w.told + 1; i < w.work.size(); ++i) ended_.push_back({w.work[i], {worker_report::outcome::not_begun, {}}});
}

}  // namespace rtusim
