#include "testbench/sweep/worker_pool.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "modules/config/error.h"

namespace rtusim {
namespace {

using namespace std::chrono_literals;

/// A pipe both of whose ends are closed at its end.
struct pipe_ends {
  std::array<int, 2> ends{-1, -1};
  pipe_ends() { REQUIRE(pipe(ends.data()) == 0); }
  ~pipe_ends() {
    for (const int end : ends) close(end);
  }
};

/// The processes that live are those that hold the pipe open for writing: whether none does within 20 s.
bool all_end(pipe_ends& alive) {
  close(std::exchange(alive.ends[1], -1));
  const auto begin = std::chrono::steady_clock::now();
  char byte;
  // The read returns as the last of them ends; the alarm is for a test that fails.
  alarm(60);
  while (read(alive.ends[0], &byte, 1) > 0) continue;
  alarm(0);
  return std::chrono::steady_clock::now() - begin < 20s;
}

worker_report sleeping(unsigned seconds) {
  for (unsigned i = 0; i < 10 * seconds; ++i) usleep(100'000);
  return {};
}

}  // namespace

TEST_CASE("worker pool: each piece of work is told with how it ended", "[testbench]") {
  worker_pool pool(3);
  CHECK(pool.empty());
  pool.start({7}, [](std::size_t) { return worker_report{}; });
  CHECK_FALSE(pool.empty());
  CHECK_FALSE(pool.full());
  pool.start({8}, [](std::size_t) -> worker_report { throw input_error("a file", "nothing", "something"); });
  pool.start({9}, [](std::size_t) { return worker_report{worker_report::outcome::unwritable, "no room"}; });
  CHECK(pool.full());
  std::set<std::size_t> ended;
  while (!pool.empty()) {
    const auto e = pool.next(10s);
    REQUIRE(e);
    ended.insert(e->work);
    if (e->work == 7) CHECK(e->report.how == worker_report::outcome::done);
    if (e->work == 8) {
      CHECK(e->report.how == worker_report::outcome::failed);
      CHECK(e->report.reason == "a file: nothing; expected something");
    }
    if (e->work == 9) {
      CHECK(e->report.how == worker_report::outcome::unwritable);
      CHECK(e->report.reason == "no room");
    }
  }
  CHECK(ended == std::set<std::size_t>{7, 8, 9});
}

TEST_CASE("worker pool: one that was killed has failed, and patience ends", "[testbench]") {
  worker_pool pool(1);
  pool.start({1}, [](std::size_t) -> worker_report {
    std::raise(SIGKILL);
    return {};
  });
  const auto e = pool.next(10s);
  REQUIRE(e);
  CHECK(e->report.how == worker_report::outcome::failed);
  CHECK_FALSE(e->report.reason.empty());
  pool.start({2}, [](std::size_t) { return sleeping(60); });
  CHECK_FALSE(pool.next(50ms));
  CHECK(pool.full());
}

TEST_CASE("worker pool: several pieces of work a worker, one of which kills it", "[testbench]") {
  worker_pool pool(2);
  const std::string long_reason(5000, 'x');
  pool.start({4, 5, 6, 7, 8}, [&](std::size_t number) -> worker_report {
    if (number == 5) return {worker_report::outcome::failed, long_reason};
    if (number == 6) throw simulation_error("no way");
    if (number == 7) std::raise(SIGKILL);
    return {};
  });
  pool.start({1, 2, 3}, [](std::size_t) { return worker_report{}; });
  CHECK(pool.full());
  std::map<std::size_t, worker_report> told;
  while (!pool.empty()) {
    const auto e = pool.next(10s);
    REQUIRE(e);
    REQUIRE(told.emplace(e->work, e->report).second);
  }
  REQUIRE(told.size() == 8);
  for (const std::size_t done : {1u, 2u, 3u, 4u}) CHECK(told[done].how == worker_report::outcome::done);
  CHECK(told[5].how == worker_report::outcome::failed);
  CHECK(told[5].reason == long_reason.substr(0, 4000));
  CHECK(told[6].how == worker_report::outcome::failed);
  CHECK(told[6].reason == "no way");
  CHECK(told[7].how == worker_report::outcome::failed);
  CHECK_THAT(told[7].reason, Catch::StartsWith("the worker was ended by signal 9"));
  CHECK(told[8].how == worker_report::outcome::not_begun);
}

TEST_CASE("worker pool: workers end with the pool", "[testbench]") {
  pipe_ends alive;
  {
    worker_pool pool(2);
    pool.start({1}, [](std::size_t) { return sleeping(40); });
    pool.start({2}, [](std::size_t) { return sleeping(40); });
  }
  CHECK(all_end(alive));
}

TEST_CASE("worker pool: workers end with a process that is killed", "[testbench]") {
  pipe_ends alive, begun;
  const pid_t sweep = fork();
  if (sweep == 0) {
    worker_pool pool(2);
    const auto work = [&begun](std::size_t) {
      static_cast<void>(write(begun.ends[1], "b", 1) == 1);
      return sleeping(40);
    };
    pool.start({1}, work);
    pool.start({2}, work);
    for (;;) pause();
  }
  char byte;
  for (int i = 0; i < 2; ++i) REQUIRE(read(begun.ends[0], &byte, 1) == 1);
  kill(sweep, SIGKILL);
  waitpid(sweep, nullptr, 0);
  CHECK(all_end(alive));
}

}  // namespace rtusim
