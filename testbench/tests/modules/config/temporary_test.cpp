#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <set>
#include <string>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/temporary.h"
#include "testbench/tests/scratch.h"

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

/// A child that has written a part of a file and waits; `prepare` runs in it first.
template <class Prepare>
pid_t writing_child(const fs::path& file, Prepare&& prepare) {
  int ready[2];
  REQUIRE(pipe(ready) == 0);
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    prepare();
    output_file out(file);
    out.write("half");
    out.descriptor();
    if (write(ready[1], "x", 1) != 1) _exit(9);
    while (true) pause();
  }
  char ignored;
  REQUIRE(read(ready[0], &ignored, 1) == 1);
  close(ready[0]);
  close(ready[1]);
  return child;
}

int status_of(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

}  // namespace

TEST_CASE("temporary: signals that end the process remove what it was writing", "[temporary]") {
  const test::scratch_folder folder;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU}) {
    const pid_t child = writing_child(folder / "out.csv", [] {
      const rlimit no_core{0, 0};
      setrlimit(RLIMIT_CORE, &no_core);
      remove_temporaries_on_signals();
    });
    CHECK(names_in(folder / "").size() == 1);
    kill(child, number);
    const int status = status_of(child);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == number);
    CHECK(folder.empty());
  }
}

TEST_CASE("temporary: a signal that is ignored stays so, and a forked process leaves its parent's files", "[temporary]") {
  const test::scratch_folder folder;
  const pid_t child = writing_child(folder / "out.csv", [] {
    std::signal(SIGHUP, SIG_IGN);
    remove_temporaries_on_signals();
  });
  kill(child, SIGHUP);
  kill(child, SIGCONT);
  CHECK(kill(child, 0) == 0);
  CHECK(names_in(folder / "").size() == 1);
  kill(child, SIGTERM);
  CHECK(WTERMSIG(status_of(child)) == SIGTERM);
  CHECK(folder.empty());

  output_file out(folder / "parent.csv");
  const pid_t forked = fork();
  if (forked == 0) {
    remove_temporaries();
    _exit(0);
  }
  CHECK(status_of(forked) == 0);
  CHECK(names_in(folder / "").size() == 1);
}

TEST_CASE("temporary: the next process removes what dead ones left, and nothing else", "[temporary]") {
  const test::scratch_folder folder;
  const pid_t killed = writing_child(folder / "out.csv", [] {});
  const pid_t living = writing_child(folder / "other.tar.gz", [] {});
  REQUIRE(names_in(folder / "").size() == 2);
  kill(killed, SIGKILL);
  siginfo_t info;
  REQUIRE(waitid(P_PID, static_cast<id_t>(killed), &info, WEXITED | WNOWAIT) == 0);  // dead, and not yet asked about

  const std::string own = process_mark();
  const std::string host = own.substr(0, own.find('-'));
  const std::string dead = host + "-4200000-12";  // beyond the largest number of a process
  std::set<std::string> kept = names_in(folder / "");
  for (auto i = kept.begin(); i != kept.end();)
    i = i->find(fmt::format("-{}-", killed)) == std::string::npos ? std::next(i) : kept.erase(i);
  const std::string others[] = {".a.part-" + dead + ".csv",
                                "a.part-" + dead + "-0.csv",
                                ".a.part-" + dead + "-0.csv.gz",
                                ".a.part-" + dead + "-x.csv",
                                ".a.part-" + host + "%2d7-4200000-12-0.csv",
                                ".a.part-x" + dead + "-0.csv",
                                ".a.part-4200000",
                                ".a.part-" + dead + "-",
                                ".a.part-",
                                ".a.part-" + host + "-4200000-12-0-0.csv",
                                ".a.part-" + own + "-7.csv"};
  for (const std::string& name : others) {
    folder.file(name, "");
    kept.insert(name);
  }
  fs::create_directory(folder / (".b.part-" + dead + "-0"));
  kept.insert(".b.part-" + dead + "-0");
  folder.file(".a.part-" + dead + "-0.csv", "");
  folder.file(".a.part-b.part-" + dead + "-12", "");
  const std::string recycled = own.substr(0, own.rfind('-')) + "-1";  // of an earlier process with our number
  folder.file(".a.part-" + recycled + "-0.csv", "");
  output_file(folder / "new.csv").commit();
  kept.insert("new.csv");
  CHECK(names_in(folder / "") == kept);

  CHECK(is_of_dead_process(dead));
  CHECK(is_of_dead_process(recycled));
  CHECK(!is_of_dead_process(own));
  CHECK(!is_of_dead_process(fmt::format("{}-1-", host)));
  kill(living, SIGKILL);
  status_of(living);
  status_of(killed);
}

TEST_CASE("temporary: a file that grows too large, or a pipe that nobody reads, is an error and no end", "[temporary]") {
  const test::scratch_folder folder;
  const pid_t child = fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    const rlimit little{10, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &little);
    int ends[2];
    if (pipe(ends) != 0) _exit(9);
    close(ends[0]);
    int failed = 0;
    for (const fs::path& file : {folder / "out", fs::path(fmt::format("/dev/fd/{}", ends[1]))}) {
      try {
        output_file out(file);
        out.write("more than ten bytes");
        out.commit();
      } catch (const input_error& e) {
        const std::string text = e.what();
        failed += text.find("File too large") != std::string::npos || text.find("Broken pipe") != std::string::npos;
      }
    }
    _exit(failed);
  }
  const int status = status_of(child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 2);
  CHECK(folder.empty());
}

}  // namespace rtusim::config
