#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "testbench/tests/scratch.h"

/// The program itself, as its user calls it.
namespace rtusim::test {

using words = std::vector<std::string>;

struct outcome {
  int status = -1;  // of its exit; -1 when it was killed
  std::string out, err;
};

/// What a run of the program may not do, and where it finds others.
struct limits {
  rlim_t most_bytes = RLIM_INFINITY;   // of a file, which looks like a disk that is full
  rlim_t most_memory = RLIM_INFINITY;  // bytes of addresses
  bool file_signal = false;            // a file that gets too large ends the process
  const char* path = nullptr;          // PATH in place of ours
};

inline std::string text_of(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
  return text;
}

/// Starts the program in a folder.
inline pid_t start_rtusim(const std::filesystem::path& folder, const words& arguments, std::FILE* out, std::FILE* err,
                          const limits& l = {}) {
  std::string program = RTUSIM_BINARY;
  words copies = arguments;
  std::vector<char*> argv{program.data()};
  for (std::string& a : copies) argv.push_back(a.data());
  argv.push_back(nullptr);
  const std::string home = folder.string();
  const pid_t child = fork();
  if (child != 0) return child;
  const rlimit bytes{l.most_bytes, RLIM_INFINITY}, seconds{60, 60}, memory{l.most_memory, RLIM_INFINITY};  // a loop without end is killed
  setrlimit(RLIMIT_FSIZE, &bytes);
  setrlimit(RLIMIT_CPU, &seconds);
  setrlimit(RLIMIT_AS, &memory);
  std::signal(SIGXFSZ, l.file_signal ? SIG_DFL : SIG_IGN);
  if (l.path != nullptr) setenv("PATH", l.path, 1);
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(fileno(out), STDOUT_FILENO);
  dup2(fileno(err), STDERR_FILENO);
  if (chdir(home.c_str()) == 0) execv(argv[0], argv.data());
  _exit(127);
}

/// Runs the program in a folder.
inline outcome rtusim(const std::filesystem::path& folder, const words& arguments, const limits& l) {
  using file = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  const file out(std::tmpfile(), &std::fclose), err(std::tmpfile(), &std::fclose);
  int status = 0;
  waitpid(start_rtusim(folder, arguments, out.get(), err.get(), l), &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out.get()), text_of(err.get())};
}

inline outcome rtusim(const std::filesystem::path& folder, const words& arguments, rlim_t most_bytes = RLIM_INFINITY) {
  limits l;
  l.most_bytes = most_bytes;
  return rtusim(folder, arguments, l);
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace rtusim::test
