// Gives every reader thousands of broken files, each in a process of its own: see target.h for what is a fault.
//
//     rtusim_mutations [CASES] [TARGET]...      10,000 of each if nothing is said
//     rtusim_mutations --seeds DIR              writes the files that the targets begin with: DIR/TARGET/NUMBER
//
// Case n of a target is the same file in every run. One that fails is left in the present folder.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "modules/config/error.h"
#include "testbench/tests/fuzz/target.h"
#include "testbench/tests/random.h"
#include "testbench/tests/scratch.h"

namespace rtusim::fuzz {
namespace {

constexpr long most_kilobytes = 1 << 20;
constexpr rlim_t most_seconds = 10;   // of the processor
constexpr unsigned most_minutes = 2;  // whoever else uses it

using test::rng;

// --- mutations ---

std::size_t below(rng& random, std::size_t size) { return size == 0 ? 0 : random() % size; }

// Puts an extreme in the place of a number of a text, or one that may be sound.
void replace_number(std::string& s, rng& random) {
  constexpr const char* extremes[] = {
      "0",   "-1",   "1e308", "-1e-308", "nan", "inf",   "4294967295", "4294967296", "2147483648", "999999999", "18446744073709551616",
      "1e9", "0x7f", "",      "1.5.5",   "-",   "65536", "255",        "1000000000"};
  constexpr std::string_view digits = "0123456789";
  const std::size_t from = s.find_first_of(digits, below(random, s.size()));
  if (from == s.npos) return;
  const std::size_t to = std::min(s.find_first_not_of("0123456789.eE", from), s.size());
  s.replace(from, to - from, random() % 2 == 0 ? extremes[below(random, std::size(extremes))] : fmt::format("{}", random() % 200));
}

void replace_word(std::string& s, rng& random) {
  constexpr std::uint32_t extremes[] = {0,       1,          0x7f,       0xff,       0x7fff,     0xffff,
                                        0x10000, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000};
  const std::uint32_t word = extremes[below(random, std::size(extremes))];
  if (s.size() < sizeof word) return;
  std::memcpy(&s[below(random, s.size() - sizeof word + 1)], &word, sizeof word);
}

void mutate_once(std::string& s, rng& random) {
  if (s.empty()) s = "x";
  // Half of them near the beginning, where headers are.
  const std::size_t reach = random() % 2 == 0 ? std::min<std::size_t>(s.size(), 300) : s.size();
  const std::size_t at = below(random, reach), length = 1 + below(random, std::min<std::size_t>(s.size() - at, 64));
  switch (random() % 11) {
    case 0: s[at] = static_cast<char>(s[at] ^ (1 << random() % 8)); break;
    case 1: s[at] = static_cast<char>(random()); break;
    case 2: s.erase(at, length); break;
    case 3: s.insert(at, s.substr(at, length)); break;
    case 4: s.insert(at, s.substr(below(random, s.size()), length)); break;
    case 5: s.resize(below(random, s.size())); break;
    case 6:
      s.insert(at, std::string(1 + random() % 2000, static_cast<char>(random() % 2 == 0 ? random() : static_cast<unsigned char>(s[at]))));
      break;
    case 7: replace_word(s, random); break;
    case 8:
    case 9: replace_number(s, random); break;
    case 10: {
      const std::size_t line = std::min(s.find('\n', at), s.size() - 1), end = std::min(s.find('\n', line + 1), s.size() - 1);
      s.erase(line, end - line);
      break;
    }
  }
}

std::string mutant(const target& t, const std::vector<std::string>& seeds, unsigned number) {
  if (number < seeds.size()) return seeds[number];
  std::uint32_t name = 0;
  for (const char c : t.name) name = 31 * name + static_cast<unsigned char>(c);
  rng random(number * 64 + name);
  std::string s = seeds[number % seeds.size()];
  for (unsigned n = 1 + random() % (number % 3 == 0 ? 8 : 2); n != 0; --n) mutate_once(s, random);
  return s;
}

// --- the runs ---

enum class ending : std::uint8_t { accepted, refused, faulty };
constexpr std::size_t endings = 3;
constexpr int first_status = 20;  // the sanitizers end with 1

// In the child.
ending try_reading(const target& t, const std::filesystem::path& file) {
  try {
    t.read(file);
    return ending::accepted;
  } catch (const input_error&) {
    return ending::refused;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return ending::faulty;
  }
}

struct figures {
  std::array<unsigned, endings> count{};
  long kilobytes = 0;
  double seconds = 0;
};

ending run_case(const target& t, const std::string& bytes, unsigned number, figures& sum) {
  const test::scratch_folder folder;
  const auto file = place(folder / "", t, bytes);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit processor{most_seconds, most_seconds};
    setrlimit(RLIMIT_CPU, &processor);
    alarm(60 * most_minutes);
    _exit(first_status + static_cast<int>(try_reading(t, file)));
  }
  int status = 0;
  rusage use{};
  wait4(child, &status, 0, &use);
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  sum.kilobytes = std::max(sum.kilobytes, use.ru_maxrss);
  sum.seconds = std::max(sum.seconds, seconds(use.ru_utime) + seconds(use.ru_stime));
  const int ended_with = WIFEXITED(status) ? WEXITSTATUS(status) - first_status : -1;
  const bool ended = ended_with >= 0 && ended_with < static_cast<int>(endings);
  auto how = ended ? static_cast<ending>(ended_with) : ending::faulty;
  if (use.ru_maxrss > most_kilobytes) how = ending::faulty;
  ++sum.count[static_cast<std::size_t>(how)];
  if (how != ending::faulty) return how;
  const std::string kept = fmt::format("mutant-{}-{}", t.name, number);
  std::filesystem::copy_file(file, kept, std::filesystem::copy_options::overwrite_existing);
  fmt::print(stderr, "{}: {}, {} MB\n", kept, ended ? "an error of ours" : fmt::format("status {:#x}", status), use.ru_maxrss / 1024);
  return how;
}

bool run(const target& t, unsigned cases) {
  const auto seeds = t.seeds();
  figures sum;
  bool sound_is_read = true;
  for (unsigned n = 0; n < cases; ++n) {
    const ending how = run_case(t, mutant(t, seeds, n), n, sum);
    if (n == 0) sound_is_read = how == ending::accepted;
  }
  fmt::print("{:12}{:>8}{:>10}{:>9}{:>8}{:>10.2f}{:>8}\n", t.name, cases, sum.count[0], sum.count[1], sum.count[2], sum.seconds,
             sum.kilobytes / 1024);
  std::fflush(stdout);
  if (!sound_is_read) fmt::print(stderr, "{}: its first file, which is sound, was not accepted\n", t.name);
  return sound_is_read && sum.count[2] == 0;
}

int run_all(unsigned cases, const std::vector<std::string>& wanted) {
  bool good = true;
  fmt::print("{:12}{:>8}{:>10}{:>9}{:>8}{:>10}{:>8}\n", "target", "cases", "accepted", "refused", "faulty", "most s", "MB");
  for (const std::string& name : wanted)
    if (std::none_of(targets().begin(), targets().end(), [&](const target& t) { return t.name == name; })) {
      fmt::print(stderr, "no target {}\n", name);
      good = false;
    }
  for (const target& t : targets())
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), t.name) != wanted.end()) good &= run(t, cases);
  return good ? 0 : 1;
}

int write_seeds(const std::filesystem::path& folder) {
  for (const target& t : targets()) {
    std::filesystem::create_directories(folder / t.name);
    const auto seeds = t.seeds();
    for (std::size_t n = 0; n < seeds.size(); ++n) std::ofstream(folder / t.name / std::to_string(n), std::ios::binary) << seeds[n];
  }
  return 0;
}

}  // namespace
}  // namespace rtusim::fuzz

// libsystemc wants one.
extern "C" int sc_main(int, char*[]) { return 1; }

int main(int argc, char* argv[]) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 2 && words[0] == "--seeds") return rtusim::fuzz::write_seeds(words[1]);
  constexpr unsigned usual_cases = 10'000;
  const unsigned cases = words.empty() ? usual_cases : static_cast<unsigned>(std::strtoul(words[0].c_str(), nullptr, 10));
  return rtusim::fuzz::run_all(cases, {words.begin() + (words.empty() ? 0 : 1), words.end()});
}
