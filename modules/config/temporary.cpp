#include "modules/config/temporary.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>

namespace rtusim::config {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view part_word = ".part-";
constexpr const char* unknown_start = "0";  // no process but the first begins with its machine

/// The files to remove when a signal comes: plain memory, which a handler may read at any time.
struct listed {
  enum : int { free_slot, being_filled, filled };
  std::atomic<int> state{free_slot};
  pid_t owner = 0;  // a child that was forked has no business with them
  char path[PATH_MAX];
};
std::array<listed, 64> to_remove;

std::string host_mark() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  std::string mark;
  for (const char* c = name; *c != '\0'; ++c) {
    const auto byte = static_cast<unsigned char>(*c);
    if (std::isalnum(byte) != 0 && byte < 128)
      mark += *c;
    else
      mark += fmt::format("%{:02x}", byte);
  }
  return mark;
}

/// A process as /proc tells it.
struct process_state {
  std::string start;  // clock ticks
  bool ended;         // though its parent has not asked yet
};

std::optional<process_state> state_of(const std::string& pid) {
  std::ifstream file("/proc/" + pid + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto name_end = text.rfind(')');  // the program's name may hold blanks and parentheses
  if (name_end == std::string::npos) return {};
  constexpr unsigned before_start = 19;  // fields from the state, the 3rd, to the start, the 22nd
  std::size_t at = name_end + 2;
  if (at >= text.size()) return {};
  const char state = text[at];
  for (unsigned i = 0; i < before_start; ++i) {
    at = text.find(' ', at);
    if (at == std::string::npos) return {};
    ++at;
  }
  return process_state{text.substr(at, text.find(' ', at) - at), state == 'Z' || state == 'X'};
}

/// Takes a decimal number from the beginning of a text.
std::optional<std::string_view> take_digits(std::string_view& text) {
  const auto end = std::min(text.find_first_not_of("0123456789"), text.size());
  if (end == 0) return {};
  const auto digits = text.substr(0, end);
  text.remove_prefix(end);
  return digits;
}

bool take(std::string_view& text, std::string_view expected) {
  if (text.substr(0, expected.size()) != expected) return false;
  text.remove_prefix(expected.size());
  return true;
}

/// The mark in a name that `temporary_file` gives; empty if it is none.
std::string_view mark_in(std::string_view name) {
  const auto word = name.rfind(part_word);
  if (word == std::string_view::npos || word < 1 || name.front() != '.') return {};
  const std::string_view tail = name.substr(word + part_word.size());
  const auto dot = tail.find('.');
  const std::string_view numbered = tail.substr(0, dot);
  if (dot != std::string_view::npos && tail.find('.', dot + 1) != std::string_view::npos) return {};
  const auto dash = numbered.rfind('-');
  if (dash == std::string_view::npos) return {};
  std::string_view number = numbered.substr(dash + 1);
  return take_digits(number) && number.empty() ? numbered.substr(0, dash) : std::string_view();
}

fs::path part_name(const fs::path& target, unsigned number) {
  const std::string end = fmt::format("{}{}-{}{}", part_word, process_mark(), number, target.extension().string());
  std::string stem = target.stem().string();
  if (const std::size_t room = NAME_MAX - std::min<std::size_t>(NAME_MAX - 1, end.size() + 1); stem.size() > room) stem.resize(room);
  fs::path part = target;
  part.replace_filename("." + stem + end);
  return part;
}

extern "C" void end_by_signal(int number) {
  remove_temporaries();
  ::raise(number);  // its default action again, once this returns
}

}  // namespace

std::string process_mark() {
  const std::string pid = std::to_string(::getpid());
  const auto state = state_of(pid);
  return fmt::format("{}-{}-{}", host_mark(), pid, state ? state->start : unknown_start);
}

bool is_of_dead_process(std::string_view mark) {
  if (!take(mark, host_mark()) || !take(mark, "-")) return false;
  const auto pid = take_digits(mark);
  if (!pid || !take(mark, "-")) return false;
  const auto start = take_digits(mark);
  if (!start || !mark.empty()) return false;
  pid_t number = 0;
  if (std::from_chars(pid->data(), pid->data() + pid->size(), number).ec != std::errc{} || number <= 0) return false;
  const auto state = state_of(std::string(*pid));
  if (state && *start != unknown_start) return state->ended || state->start != *start;
  return ::kill(number, 0) != 0 && errno == ESRCH;
}

temporary_file::temporary_file(const fs::path& target, unsigned number) : path_(part_name(target, number)) {
  if (path_.native().size() >= PATH_MAX) return;
  for (unsigned i = 0; i < to_remove.size(); ++i) {
    int expected = listed::free_slot;
    if (!to_remove[i].state.compare_exchange_strong(expected, listed::being_filled)) continue;
    to_remove[i].owner = ::getpid();
    std::memcpy(to_remove[i].path, path_.c_str(), path_.native().size() + 1);
    to_remove[i].state = listed::filled;
    slot_ = i;
    return;
  }
}

temporary_file::~temporary_file() {
  if (!path_.empty()) ::unlink(path_.c_str());
  keep();
}

void temporary_file::keep() {
  path_.clear();
  if (slot_ != unlisted) to_remove[slot_].state = listed::free_slot;
  slot_ = unlisted;
}

void remove_leftovers(const fs::path& folder) {
  static std::mutex access;
  static std::set<fs::path> looked_through;
  const fs::path at = folder.empty() ? fs::path(".") : folder;
  {
    const std::lock_guard<std::mutex> lock(access);
    if (!looked_through.insert(at).second) return;
  }
  std::error_code error;
  for (fs::directory_iterator i(at, error), end; !error && i != end; i.increment(error)) {
    const std::string name = i->path().filename().string();
    const std::string_view mark = mark_in(name);
    std::error_code ignored;
    if (!mark.empty() && i->symlink_status(ignored).type() == fs::file_type::regular && is_of_dead_process(mark))
      fs::remove(i->path(), ignored);
  }
}

void remove_temporaries() noexcept {
  const int before = errno;
  const pid_t self = ::getpid();
  for (listed& l : to_remove)
    if (l.state == listed::filled && l.owner == self) ::unlink(l.path);
  errno = before;
}

void remove_temporaries_on_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU}) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // as nohup wants it
    action = {};
    action.sa_handler = end_by_signal;
    action.sa_flags = SA_RESETHAND;
    ::sigaction(number, &action, nullptr);
  }
  for (const int number : {SIGPIPE, SIGXFSZ}) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = [](int) {};  // not SIG_IGN, which programs that we start would inherit
    action.sa_flags = SA_RESTART;
    ::sigaction(number, &action, nullptr);
  }
}

}  // namespace rtusim::config
