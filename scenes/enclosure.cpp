#include "scenes/enclosure.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "modules/config/error.h"

namespace rtusim {
namespace {

// The importer keeps some 20 bytes for one of a binary mesh, some 10 for one of a text.
constexpr std::uint64_t least_memory_bytes = std::uint64_t{512} << 20, memory_bytes_a_byte = 64;
constexpr std::uint64_t least_seconds = 20, bytes_a_second = 1'000'000;

enum class outcome : std::uint8_t { made, refused, out_of_memory, failed };

// One end of a pipe, closed when it goes.
class pipe_end {
 public:
  explicit pipe_end(int descriptor) : descriptor_(descriptor) {}
  ~pipe_end() { close(descriptor_); }
  pipe_end(const pipe_end&) = delete;
  pipe_end& operator=(const pipe_end&) = delete;

  // False when the other end is gone.
  bool put(const void* data, std::size_t bytes) const {
    for (const char* from = static_cast<const char*>(data); bytes != 0;) {
      const ssize_t n = ::write(descriptor_, from, bytes);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      from += n;
      bytes -= static_cast<std::size_t>(n);
    }
    return true;
  }
  bool get(void* data, std::size_t bytes) const {
    for (char* to = static_cast<char*>(data); bytes != 0;) {
      const ssize_t n = ::read(descriptor_, to, bytes);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      to += n;
      bytes -= static_cast<std::size_t>(n);
    }
    return true;
  }
  template <class Container>
  bool put_all(const Container& items) const {
    const std::uint64_t size = items.size();
    return put(&size, sizeof size) && put(items.data(), size * sizeof items[0]);
  }
  // Grows as the bytes come: what announces them may be broken.
  template <class Container>
  bool get_all(Container& items) const {
    static_assert(std::is_trivially_copyable_v<typename Container::value_type>);
    constexpr std::uint64_t most_at_once = 1 << 16;
    std::uint64_t size = 0;
    if (!get(&size, sizeof size)) return false;
    while (items.size() < size) {
      const std::size_t before = items.size();
      items.resize(static_cast<std::size_t>(std::min(size, before + most_at_once)));
      if (!get(&items[before], (items.size() - before) * sizeof items[0])) return false;
    }
    return true;
  }

 private:
  int descriptor_;
};

std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t threads() {
  std::error_code unreadable;
  const std::filesystem::directory_iterator all("/proc/self/task", unreadable);
  return unreadable ? 1 : static_cast<std::uint64_t>(std::distance(begin(all), end(all)));
}

[[noreturn]] void work_in_child(const std::function<mesh()>& work, const pipe_end& out) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  for (const int signal : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV}) std::signal(signal, SIG_DFL);  // the parent's handlers stay with it
  // What libraries say when they die; the parent says it in one line.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  outcome how = outcome::made;
  mesh made;
  std::string text;
  try {
    made = work();
  } catch (const input_error& e) {
    how = outcome::refused;
    text = e.what();
  } catch (const std::bad_alloc&) {
    how = outcome::out_of_memory;
  } catch (const std::exception& e) {
    how = outcome::failed;
    text = e.what();
  }
  const bool sent = out.put(&how, sizeof how) && out.put_all(text) && out.put_all(made.vertices) && out.put_all(made.triangles);
  _exit(sent ? 0 : 1);
}

// An input_error's text taken apart, so that putting it together again gives the same.
input_error same_again(std::string_view text) {
  constexpr std::string_view colon = ": ", semicolon = "; expected ";
  const std::size_t found = text.find(colon), expected = text.rfind(semicolon);
  if (found == text.npos || expected == text.npos || expected < found + colon.size()) return {"mesh", std::string(text), "a sound mesh"};
  return {std::string(text.substr(0, found)), std::string(text.substr(found + colon.size(), expected - found - colon.size())),
          std::string(text.substr(expected + semicolon.size()))};
}

std::string ending_of(int status) {
  if (!WIFSIGNALED(status)) return "fails";
  const int signal = WTERMSIG(status);
  return signal == SIGXCPU || signal == SIGKILL ? "takes too long" : fmt::format("crashes ({})", strsignal(signal));
}

}  // namespace

mesh enclosed(const std::string& place, const std::function<mesh()>& work) {
  RTU_CHECK(threads(), ==, 1U);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "a pipe");
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    work_in_child(work, pipe_end(ends[1]));
  }
  close(ends[1]);
  const pipe_end in(ends[0]);
  if (child < 0) throw std::system_error(errno, std::generic_category(), "a child process");

  outcome how{};
  mesh m;
  std::string text;
  const bool whole = in.get(&how, sizeof how) && in.get_all(text) && in.get_all(m.vertices) && in.get_all(m.triangles);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const auto refuse = [&](const std::string& found) { throw input_error(place, found, "a mesh that the importer reads"); };
  if (!whole || status != 0) refuse(fmt::format("the importer {} on it", ending_of(status)));
  if (how == outcome::out_of_memory) refuse("the importer runs out of memory on it");
  if (how == outcome::refused) throw same_again(text);
  if (how == outcome::failed) throw simulation_error(text);
  for (const auto& t : m.triangles)
    for (const std::uint32_t v : t)
      if (v >= m.vertices.size()) refuse(fmt::format("a triangle has vertex {} of {}", v, m.vertices.size()));
  return m;
}

import_allowance::import_allowance() : address_space_bytes_(address_space_bytes()) {}

void import_allowance::admit(std::uint64_t bytes) {
  bytes_ += bytes;
  const auto set = [](auto resource, std::uint64_t most) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
    setrlimit(resource, &limit);
  };
  set(RLIMIT_CPU, least_seconds + bytes_ / bytes_a_second);
#ifndef __SANITIZE_ADDRESS__  // which takes more of the address space for itself than any limit allows
  set(RLIMIT_AS, address_space_bytes_ + least_memory_bytes + bytes_ * memory_bytes_a_byte);
#endif
}

}  // namespace rtusim
