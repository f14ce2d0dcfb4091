#include "testbench/sweep/results_folder.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "modules/config/durable.h"
#include "modules/config/error.h"
#include "modules/config/printable.h"
#include "modules/config/temporary.h"
#include "testbench/run/interrupts.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int folder_version = 2;
constexpr int lock_patience_ms = 20;
constexpr std::string_view part_start = ".part-";

/// What a file of the folder holds now; nothing if it can't be read. It is no input of the sweep, so that no ledger notes or keeps it.
std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Whether a name is that of a part that a process of this host, which is no more, left.
bool is_left_over(std::string_view name) {
  if (name.substr(0, part_start.size()) != part_start) return false;
  const std::size_t end = name.rfind('-');  // what follows a mark has no dash
  return end > part_start.size() && config::is_of_dead_process(name.substr(part_start.size(), end - part_start.size()));
}

const std::string& mark_text() {
  static const std::string text = json{{"format", "rtusim sweep"}, {"version", folder_version}}.dump() + "\n";
  return text;
}

/// Whether a file holds what is left of another when the power went.
bool is_torn(std::string_view found, std::string_view whole) {
  const std::string_view kept = found.substr(0, std::min(found.find('\0'), found.size()));
  return found.size() <= whole.size() && found != whole && whole.substr(0, kept.size()) == kept &&
         found.find_first_not_of('\0', kept.size()) == std::string_view::npos;
}

/// Whether a sweep may have put this in its folder.
bool is_own(const fs::directory_entry& e) {
  const std::string name = e.path().filename().string();
  const auto begins = [&](std::string_view with) { return name.compare(0, with.size(), with) == 0; };
  return begins(part_start) || begins("slurm") || name == "sweep.json" || name == "lock" || name == "points" || name == "failed" ||
         name == "results.csv" || name == "results.json" || name == "plots";
}

template <class Act>
void with_folder(const fs::path& out, Act&& act) {
  try {
    act();
  } catch (const fs::filesystem_error& e) {
    throw input_error(out.string(), e.code().message(), "a folder that can be written");
  }
}

}  // namespace

results_folder::results_folder(std::filesystem::path out, const std::vector<std::string>& images) : out_(std::move(out)), images_(images) {
  own_ = fmt::format("{}{}-", part_start, config::process_mark());
  with_folder(out_, [&] {
    fs::create_directories(out_);
    mark();
  });
}

results_folder::~results_folder() {
  clean(out_, true);
  clean(out_ / "points", true);
  unlock();
}

void results_folder::mark() const {
  const fs::path file = out_ / "sweep.json";
  const auto write_mark = [&] {
    const fs::path part = out_ / (own_ + "sweep.json");
    config::write_new_file(part, mark_text());
    std::error_code failed;
    fs::rename(part, file, failed);
    if (!failed) return;
    fs::remove(part);
    throw fs::filesystem_error("rename", part, file, failed);
  };
  if (!fs::exists(file)) {
    // Another machine may just write the mark.
    const auto is_foreign = [](const fs::directory_entry& e) { return e.path().filename().string().rfind(part_start, 0) != 0; };
    if (std::any_of(fs::directory_iterator(out_), fs::directory_iterator(), is_foreign) && !fs::exists(file))
      throw input_error(out_.string(), "a folder that holds something else", "an empty folder, or that of a sweep");
    write_mark();
    return;
  }
  const std::string text = contents_of(file);
  if (is_torn(text, mark_text()) && std::all_of(fs::directory_iterator(out_), fs::directory_iterator(), is_own)) {
    write_mark();
    return;
  }
  const json found = json::parse(text, nullptr, false);
  if (!found.is_object() || !found.contains("format") || found["format"] != "rtusim sweep")
    throw input_error(file.string(), "no mark of a sweep's results", "the folder of a sweep");
  if (!found.contains("version") || found["version"] != folder_version)
    throw input_error(file.string(), fmt::format("results of version {}", found.contains("version") ? found["version"].dump() : "none"),
                      fmt::format("version {}: another folder, or those results moved away", folder_version));
}

void results_folder::lock(use how, bool tell) {
  const fs::path file = out_ / "lock";
  lock_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (lock_ < 0) throw input_error(file.string(), std::strerror(errno), "a folder that can be written");
  const int kind = how == use::whole ? LOCK_EX : LOCK_SH;
  const int error = flock(lock_, kind | LOCK_NB) == 0 ? 0 : errno;
  if (error == EWOULDBLOCK) {
    if (tell) fmt::print(stderr, "rtusim: waiting for another sweep in {} to end\n", config::printable(out_.string()));
    while (flock(lock_, kind | LOCK_NB) != 0) {  // and not without LOCK_NB: a signal just before would be noticed by none
      if (interrupts::came()) throw simulation_error("sweep: interrupted while it waited for another sweep in " + out_.string());
      ::poll(nullptr, 0, lock_patience_ms);  // a signal ends it
    }
  } else if (error != 0) {
    fmt::print(stderr, "rtusim: warning: {} lies where no locks are known: one sweep at a time\n", config::printable(out_.string()));
  }
  with_folder(out_, [&] {
    fs::create_directories(out_ / "points");
    fs::create_directories(out_ / "failed");
    clean(out_, false);
    clean(out_ / "points", false);
  });
}

void results_folder::unlock() {
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

/// Removes this process' parts, or those of processes that are no more.
void results_folder::clean(const std::filesystem::path& folder, bool own) const {
  std::error_code none;
  for (fs::directory_iterator at(folder, none), end; !none && at != end; at.increment(none)) {
    const std::string name = at->path().filename().string();
    std::error_code ignored;
    if (own ? name.rfind(own_, 0) == 0 : is_left_over(name)) fs::remove_all(at->path(), ignored);
  }
}

std::optional<nlohmann::ordered_json> results_folder::record(const sweep_task& t) const {
  const fs::path at = point(t);
  if (t.identity.empty() || contents_of(at / "identity.json") != t.identity) return {};
  for (const std::string& ending : images_) {
    std::error_code none;
    const fs::path image = at / ("image." + ending);
    if (!fs::is_regular_file(image, none) || fs::file_size(image, none) == 0 || none) return {};
  }
  json all = json::parse(contents_of(at / "stats.json"), nullptr, false);
  if (!all.is_object() || !all.contains("statistics") || !all["statistics"].is_object()) return {};
  return all;
}

std::optional<point_failure> results_folder::failure(const sweep_task& t) const {
  if (!t.failure.empty()) return point_failure{t.failure, true};
  std::error_code none;
  if (!fs::is_regular_file(failed(t), none)) return {};
  const json found = json::parse(contents_of(failed(t)), nullptr, false);
  if (!found.is_object() || found.value("identity", json()) != config::sha256_of(t.identity)) return {};
  if (!found.contains("reason") || !found["reason"].is_string()) return {};
  return point_failure{found["reason"], found.value("kept", json()) == true};
}

void results_folder::forget_failure(const sweep_task& t) const {
  std::error_code ignored;
  fs::remove(failed(t), ignored);
}

void results_folder::put(const std::vector<named_bytes>& files) const {
  with_folder(out_, [&] {
    for (const named_bytes& f : files) config::write_new_file(out_ / (own_ + f.name), f.bytes);
    config::sync_file_system(out_);
    for (const named_bytes& f : files) fs::rename(out_ / (own_ + f.name), out_ / f.name);
    config::sync_folder(out_);
  });
}

void point_batch::failed(const sweep_task& t, const point_failure& why) {
  std::error_code ignored;
  fs::remove_all(folder_.part(t), ignored);
  const json text{{"identity", config::sha256_of(t.identity)}, {"reason", why.reason}, {"kept", why.kept}};
  config::write_new_file(folder_.part(t), text.dump(-1, ' ', false, json::error_handler_t::replace) + '\n');
  failed_.push_back(&t);
}

std::chrono::milliseconds point_batch::patience() const {
  constexpr std::chrono::milliseconds most(500);
  if (done_.empty() && failed_.empty()) return most;
  return std::clamp(std::chrono::ceil<std::chrono::milliseconds>(due_ - clock::now()), std::chrono::milliseconds(0), most);
}

void point_batch::commit_if_due() {
  if ((!done_.empty() || !failed_.empty()) && clock::now() >= due_) commit();
}

void point_batch::commit() {
  if (done_.empty() && failed_.empty()) return;
  const auto begin = clock::now();
  with_folder(folder_.path(), [&] {
    // First what they hold, then their names, which the next batch, or the tables, bring to the disk: a point is there whole or not at all.
    config::sync_file_system(folder_.path());
    for (const sweep_task* t : done_) {
      std::error_code taken;
      fs::remove_all(folder_.point(*t));  // of another program, or without these pictures
      fs::rename(folder_.part(*t), folder_.point(*t), taken);
      const bool is_lost = taken && !folder_.record(*t);  // else another machine was faster
      if (is_lost) throw fs::filesystem_error("rename", folder_.part(*t), folder_.point(*t), taken);
      folder_.forget_failure(*t);
    }
    for (const sweep_task* t : failed_) fs::rename(folder_.part(*t), folder_.failed(*t));
  });
  done_.clear();
  failed_.clear();
  due_ = clock::now() + 25 * (clock::now() - begin);
}

}  // namespace rtusim
