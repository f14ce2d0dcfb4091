#include "testbench/sweep_command.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "modules/config/error.h"
#include "modules/config/files.h"
#include "testbench/pictures.h"
#include "testbench/replay.h"
#include "testbench/run_pictures.h"
#include "testbench/run_setup.h"
#include "testbench/summary.h"
#include "testbench/sweep_plan.h"

namespace rtusim {
namespace {

using json = nlohmann::ordered_json;
using wall_clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr int results_version = 1;

volatile std::sig_atomic_t interrupted = 0;
extern "C" void note_interrupt(int) { interrupted = 1; }

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t h = 14695981039346656037u;
  for (const unsigned char c : text) h = (h ^ c) * 1099511628211u;
  return h;
}

/// Checksums of the files that runs read, each read once.
class file_sums {
 public:
  std::string of(const fs::path& file) {
    const auto [at, is_new] = sums_.emplace(file, "");
    if (is_new) {
      const std::string bytes = config::read_file(file);
      at->second = fmt::format("{:08x}", crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
    }
    return at->second;
  }

 private:
  std::map<fs::path, std::string> sums_;
};

/// A point of the plan with where its results lie.
struct task {
  std::size_t number = 0;
  const sweep_plan::point* point = nullptr;
  std::string identity;  ///< all that determines the run
  std::string hash;      ///< of that
  std::string walk;      ///< what of it determines the rays' walks
  std::string failure;   ///< why it can't be run
};

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

/// The folder of a sweep's results.
class results_folder {
 public:
  explicit results_folder(const fs::path& out, const std::vector<std::string>& images) : out_(out), images_(images) {
    try {
      open();
    } catch (const fs::filesystem_error& e) {
      throw input_error(out_.string(), e.code().message(), "a folder that can be written");
    }
  }

  fs::path point(const task& t) const { return out_ / "points" / t.hash; }
  fs::path failure(const task& t) const { return out_ / "failed" / t.hash; }
  /// Where a worker writes before a point is whole; other machines may work in the same folder.
  fs::path part(const task& t, pid_t worker) const { return out_ / "points" / fmt::format(".part-{}-{}-{}", host_name(), worker, t.hash); }
  const fs::path& path() const { return out_; }

  /// Whether a point's results are whole: of this very run, with all pictures that are asked for.
  bool has(const task& t) const {
    const fs::path at = point(t);
    if (!fs::is_regular_file(at / "stats.json") || !fs::is_regular_file(at / "identity.json")) return false;
    for (const std::string& ending : images_)
      if (!fs::is_regular_file(at / ("image." + ending))) return false;
    return config::read_file(at / "identity.json") == t.identity;
  }

 private:
  void open() {
    fs::create_directories(out_);
    const fs::path mark = out_ / "sweep.json";
    if (!fs::exists(mark)) {
      // What begins with a dot may be this mark, as another machine just writes it.
      const auto is_foreign = [](const fs::directory_entry& e) { return e.path().filename().string().rfind(".sweep.part-", 0) != 0; };
      if (std::any_of(fs::directory_iterator(out_), fs::directory_iterator(), is_foreign) && !fs::exists(mark))
        throw input_error(out_.string(), "a folder that holds something else", "an empty folder, or that of a sweep");
      config::output_file file(mark);
      file.write(json{{"format", "rtusim sweep"}, {"version", results_version}}.dump() + "\n");
      file.commit();
    }
    const json found = json::parse(config::read_file(mark), nullptr, false);
    if (!found.is_object() || !found.contains("format") || found["format"] != "rtusim sweep")
      throw input_error(mark.string(), "no mark of a sweep's results", "the folder of a sweep");
    if (!found.contains("version") || found["version"] != results_version)
      throw input_error(mark.string(), fmt::format("results of version {}", found.contains("version") ? found["version"].dump() : "none"),
                        fmt::format("version {}: another folder, or those results moved away", results_version));
    fs::create_directories(out_ / "points");
    fs::create_directories(out_ / "failed");
    // What a worker of this machine that was killed left.
    const std::string start = ".part-" + host_name() + '-';
    for (const auto& entry : fs::directory_iterator(out_ / "points")) {
      const std::string name = entry.path().filename().string();
      if (name.rfind(start, 0) == 0 && kill(static_cast<pid_t>(std::atol(name.c_str() + start.size())), 0) != 0)
        fs::remove_all(entry.path());
    }
  }

  fs::path out_;
  const std::vector<std::string>& images_;
};

/// The sections of a record, with those of the testbench left out.
json sections_of(const json& parameters, std::initializer_list<const char*> names) {
  json some = json::object();
  for (const char* name : names)
    if (parameters.contains(name)) some[name] = parameters[name];
  return some;
}

std::vector<task> tasks_of(const sweep_plan& plan) {
  file_sums sums;
  std::vector<task> tasks;
  for (std::size_t i = 0; i < plan.points().size(); ++i) {
    task t;
    t.number = i;
    t.point = &plan.points()[i];
    try {
      const auto s = plan.setup(*t.point);
      const json parameters = s->parameters.values();
      const std::string model = sums.of(s->what.model.model) + (s->what.model.rays.empty() ? "" : sums.of(s->what.model.rays));
      t.identity = json{{"statistics", run_record::version}, {"model", model}, {"parameters", parameters}}.dump() + "\n";
      t.walk = json{{"model", model},
                    {"parameters", sections_of(parameters, {"scene", "frame", "camera", "driver", "fixed_point", "float_to_fixed",
                                                            "svo_core", "memory", "quantisation", "bih_builder"})},
                    {"address_bits", parameters.value("/bih_core/address_bits"_json_pointer, 0)}}
                   .dump();
    } catch (const input_error& e) {
      t.identity = fmt::format("point {} of {}: {}\n", i, plan.scene(*t.point).string(), e.what());
      t.failure = e.what();
    }
    t.hash = fmt::format("{:016x}", fnv1a(t.identity));
    tasks.push_back(std::move(t));
  }
  return tasks;
}

/// What the points of one walk share: the model, the rays, and where replay holds their walks.
struct shared_rays {
  shared_rays(const run_setup& s, bool pictured) : model(s), sent(model.jobs(s, 1, pictured)), jobs(sent.packets) {
    if (replay_obstacle(s.unit, s.bench).empty()) walked.emplace(walk_rays(s.unit, model.octree(), jobs, 1));
  }
  loaded_model model;
  sent_jobs sent;
  const std::vector<job_packet>& jobs;
  std::optional<walked_rays> walked;
};

/// Runs a point, in a process of its own, and leaves its folder.
void run_point(const sweep_plan& plan, const task& t, const shared_rays& shared, const results_folder& folder) {
  const auto begin = wall_clock::now();
  const auto s = plan.setup(*t.point);
  shared.model.settle(*s);
  std::optional<run_pictures> shown;
  result_handler handler;
  if (!plan.images().empty()) {
    shown.emplace(*s, shared.model, shared.jobs, true);
    handler = [&](cycle, const traversal_result& r, std::uint64_t latency_cycles) { shown->store(r, latency_cycles); };
  }

  run_figures figures;
  simulator_figures speed;
  if (shared.walked && replay_obstacle(s->unit, s->bench).empty()) {
    figures = replay(s->unit, s->bench, *shared.walked, handler);
    speed.pace = "replay";
  } else {
    simulation sim(s->unit, s->bench, shared.model.view(), shared.jobs, pace::skipping);
    if (handler) sim.board().on_result(handler);
    sim.run();
    figures = sim.figures();
    speed.pace = "skipping";
    speed.clock = sim.clock().stats();
  }
  figures.host = shared.sent.host;
  speed.rays = shared.jobs.size();
  speed.cycles = figures.results.total_cycles();
  speed.all_seconds = speed.run_seconds = std::chrono::duration<double>(wall_clock::now() - begin).count();

  run_record record;
  record.inputs = inputs_of(*s, shared.model, shared.jobs);
  record.inputs["scene"] = plan.scene(*t.point).string();
  record.inputs["architecture"] = plan.architecture(*t.point).string();
  record.parameters = s->parameters.values();
  config::report statistics, simulator;
  figures.describe(statistics);
  speed.describe(simulator);
  record.statistics = statistics.values();
  record.simulator = simulator.values();

  const fs::path part = folder.part(t, getpid());
  fs::create_directories(part);
  write_record(part / "stats.json", record);
  if (shown)
    shown->finish(figures, std::any_of(plan.images().begin(), plan.images().end(),
                                       [](const std::string& ending) { return shows_places(kind_of("image." + ending)); }));
  for (const std::string& ending : plan.images()) {
    const fs::path file = part / ("image." + ending);
    shown->write(file);
  }
  config::output_file identity(part / "identity.json");
  identity.write(t.identity);
  identity.commit();
  std::error_code ignored;
  fs::remove_all(folder.point(t), ignored);  // of another run with the same hash, or without these pictures
  std::error_code taken;
  fs::rename(part, folder.point(t), taken);
  if (taken && !folder.has(t)) throw fs::filesystem_error("rename", part, folder.point(t), taken);  // else another machine was faster
  fs::remove(folder.failure(t), ignored);
}

void note_failure(const results_folder& folder, const task& t, const std::string& reason) {
  config::output_file file(folder.failure(t));
  file.write(reason);
  file.commit();
}

/// A line on the terminal that tells how many points are done and how long the rest will take; nothing in a pipe.
class sweep_progress {
 public:
  sweep_progress(bool wanted, std::size_t points) : on_(wanted && isatty(STDERR_FILENO) != 0), points_(points) {}
  ~sweep_progress() {
    if (on_) fmt::print(stderr, "\r\033[K");
  }
  void done() {
    ++done_;
    if (!on_) return;
    const double spent = std::chrono::duration<double>(wall_clock::now() - begin_).count();
    fmt::print(stderr, "\r{} of {} points, {:.0f} s left \033[K", done_, points_,
               spent / static_cast<double>(done_) * static_cast<double>(points_ - done_));
  }

 private:
  bool on_;
  std::size_t points_;
  std::size_t done_ = 0;
  wall_clock::time_point begin_ = wall_clock::now();
};

/// Processes that run a point each, so many at a time.
class worker_pool {
 public:
  worker_pool(unsigned most, const results_folder& folder, sweep_progress& progress) : most_(most), folder_(folder), progress_(progress) {}
  ~worker_pool() {
    for (const auto& [pid, t] : running_) kill(pid, SIGKILL);
    for (const auto& [pid, t] : running_) {
      while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) continue;
      clean(*t, pid);
    }
  }

  /// `work` runs in a child.
  template <class Work>
  void start(const task& t, Work&& work) {
    while (running_.size() >= most_) wait_for_one();
    std::fflush(nullptr);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) throw input_error("sweep", "no process more can be started", "fewer workers: -j");
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      signal(SIGINT, SIG_DFL);
      if (getppid() != parent) _exit(1);
      _exit(run(t, work));
    }
    running_.emplace(child, &t);
  }
  void finish() {
    while (!running_.empty()) wait_for_one();
  }

 private:
  template <class Work>
  int run(const task& t, Work& work) const {
    std::string reason;
    try {
      work();
      return 0;
    } catch (const std::bad_alloc&) {
      reason = "out of memory";
    } catch (const std::exception& e) {
      reason = e.what();
    }
    try {
      note_failure(folder_, t, reason);
    } catch (const std::exception&) {  // a full disk: the parent tells
      return 2;
    }
    return 1;
  }
  /// What a worker that did not end well leaves.
  void clean(const task& t, pid_t pid) const {
    std::error_code ignored;
    fs::remove_all(folder_.part(t, pid), ignored);
  }
  void wait_for_one() {
    int status = 0;
    const pid_t pid = waitpid(-1, &status, 0);
    if (pid < 0) {
      if (errno == EINTR && interrupted == 0) return;
      if (errno == EINTR) throw simulation_error("interrupted");
      running_.clear();
      return;
    }
    const auto at = running_.find(pid);
    if (at == running_.end()) return;
    const task& t = *at->second;
    running_.erase(at);
    clean(t, pid);
    if (WIFSIGNALED(status) && interrupted == 0)
      note_failure(folder_, t, fmt::format("the worker was ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status))));
    else if (WIFEXITED(status) && WEXITSTATUS(status) == 2)
      throw input_error(folder_.path().string(), "a result that could not be written", "room on the disk");
    progress_.done();
    if (interrupted != 0) throw simulation_error("interrupted");
  }

  unsigned most_;
  const results_folder& folder_;
  sweep_progress& progress_;
  std::map<pid_t, const task*> running_;
};

/// Runs the points that have no result yet, those that share their rays one behind the other.
void run_missing(const sweep_plan& plan, const std::vector<task>& tasks, const std::vector<const task*>& missing,
                 const results_folder& folder, const sweep_options& o) {
  interrupted = 0;
  struct sigaction on_interrupt {};
  on_interrupt.sa_handler = note_interrupt;
  sigaction(SIGINT, &on_interrupt, nullptr);
  sigaction(SIGTERM, &on_interrupt, nullptr);

  std::vector<const task*> order = missing;
  std::map<std::string, std::size_t> first;
  for (const task* t : order) first.emplace(t->walk, t->number);
  std::stable_sort(order.begin(), order.end(), [&](const task* a, const task* b) { return first[a->walk] < first[b->walk]; });

  sweep_progress progress(!o.quiet, order.size());
  worker_pool pool(o.jobs, folder, progress);
  std::unique_ptr<shared_rays> shared;
  std::string shared_walk, shared_failure;
  std::set<std::string> started;
  try {
    for (const task* t : order) {
      if (!started.insert(t->hash).second) continue;  // the same run as another point
      if (!t->failure.empty()) {
        note_failure(folder, *t, t->failure);
        progress.done();
        continue;
      }
      if (!shared || shared_walk != t->walk) {
        shared.reset();
        shared_failure.clear();
        shared_walk = t->walk;
        try {
          shared = std::make_unique<shared_rays>(*plan.setup(*t->point), !plan.images().empty());
        } catch (const input_error& e) {
          shared_failure = e.what();
        } catch (const simulation_error& e) {
          shared_failure = e.what();
        } catch (const std::bad_alloc&) {
          shared_failure = "out of memory";
        }
      }
      if (!shared) {
        note_failure(folder, *t, shared_failure);
        progress.done();
        continue;
      }
      pool.start(*t, [&] { run_point(plan, *t, *shared, folder); });
    }
    pool.finish();
  } catch (const simulation_error&) {
    if (interrupted == 0) throw;
    const auto done = static_cast<std::size_t>(std::count_if(tasks.begin(), tasks.end(), [&](const task& t) { return folder.has(t); }));
    throw simulation_error(fmt::format("sweep: interrupted; {} of {} points are done, and the same command goes on", done, tasks.size()));
  }
}

std::string csv_field(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

/// Gathers the results of all points in the order of the plan; how many have none.
std::size_t gather(const sweep_plan& plan, const std::vector<task>& tasks, const results_folder& folder) {
  std::vector<std::string> columns;
  std::set<std::string> known;
  struct row {
    const task* of;
    std::string reason;
    std::map<std::string, json> figures;
  };
  std::vector<row> rows;
  std::size_t failed = 0;
  std::set<std::string> missing(plan.record().begin(), plan.record().end());
  for (const task& t : tasks) {
    row r{&t, {}, {}};
    if (!folder.has(t)) {
      ++failed;
      r.reason = fs::is_regular_file(folder.failure(t)) ? config::read_file(folder.failure(t)) : "not run";
      rows.push_back(std::move(r));
      continue;
    }
    const json all = json::parse(config::read_file(folder.point(t) / "stats.json"), nullptr, false);
    if (!all.is_object() || !all.contains("statistics"))
      throw input_error((folder.point(t) / "stats.json").string(), "no statistics file",
                        "this folder removed, so that the point is run again");
    for (const std::string& key : plan.record()) {
      if (key.find_first_of("~/") != std::string::npos) continue;
      std::string pointer = '/' + key;
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      const json::json_pointer at(pointer);
      if (!all["statistics"].contains(at)) continue;
      missing.erase(key);
      std::vector<std::pair<std::string, json>> figures;
      flatten(all["statistics"].at(at), key, figures);
      for (auto& [name, value] : figures) {
        if (value.is_array()) continue;
        if (known.insert(name).second) columns.push_back(name);
        r.figures.emplace(name, std::move(value));
      }
    }
    rows.push_back(std::move(r));
  }
  if (!missing.empty() && failed < tasks.size())
    throw input_error("sweep.record", fmt::format("{}, which no point has", fmt::join(missing, ", ")), "figures of these designs");

  std::string csv = "point,scene,architecture";
  for (const std::string& key : plan.axes()) csv += ',' + csv_field(key);
  csv += ",status,reason";
  for (const std::string& name : columns) csv += ',' + csv_field(name);
  csv += '\n';
  json points = json::array();
  for (const row& r : rows) {
    const sweep_plan::point& p = *r.of->point;
    const bool done = r.reason.empty();
    csv += fmt::format("{},{},{}", r.of->hash, csv_field(plan.scene(p).string()), csv_field(plan.architecture(p).string()));
    json axes = json::object(), figures = json::object();
    for (std::size_t i = 0; i < p.values.size(); ++i) {
      csv += ',' + csv_field(p.values[i]->shown);
      axes[plan.axes()[i]] = p.values[i]->shown;
    }
    csv += fmt::format(",{},{}", done ? "done" : "failed", csv_field(r.reason));
    for (const std::string& name : columns) {
      csv += ',';
      const auto at = r.figures.find(name);
      if (at == r.figures.end()) continue;
      csv += at->second.is_string() ? csv_field(at->second.get<std::string>()) : at->second.dump();
      figures[name] = at->second;
    }
    csv += '\n';
    points.push_back({{"point", r.of->hash},
                      {"scene", plan.scene(p).string()},
                      {"architecture", plan.architecture(p).string()},
                      {"axes", axes},
                      {"status", done ? "done" : "failed"},
                      {"reason", r.reason},
                      {"figures", figures}});
  }
  config::output_file table(folder.path() / "results.csv");
  table.write(csv);
  table.commit();
  config::output_file tree(folder.path() / "results.json");
  std::vector<std::string> names = plan.axes();
  names.insert(names.end(), columns.begin(), columns.end());
  json meanings = json::object();
  for (const column_meaning& m : meanings_of(names)) meanings[m.name] = {{"unit", m.unit}, {"meaning", m.meaning}};
  const json all{{"format", "rtusim sweep results"}, {"version", results_version}, {"columns", meanings}, {"points", points}};
  tree.write(all.dump(1, ' ', false, json::error_handler_t::replace) + '\n');
  tree.commit();
  return failed;
}

struct share {
  std::uint64_t number = 0, of = 1;

  explicit share(const std::string& text) {
    if (text.empty()) return;
    const auto slash = text.find('/');
    const auto read = [&](std::size_t from, std::size_t to, std::uint64_t& value) {
      const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
      return error == std::errc{} && end == text.data() + to;
    };
    if (slash == std::string::npos || !read(0, slash, number) || !read(slash + 1, text.size(), of) || number >= of)
      throw input_error("--share", '"' + text + '"', "I/N with I from 0 to N - 1");
  }
};

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// Lets a job array of Slurm run shares of the points, and waits for it.
void submit_to_slurm(const sweep_options& o, const results_folder& folder, std::size_t missing) {
  const auto tasks = std::min<std::size_t>(missing, std::max(1u, o.jobs));
  const fs::path script = folder.path() / "slurm.sh";
  const fs::path program = fs::read_symlink("/proc/self/exe");
  {
    config::output_file file(script);
    // From this folder and with these names: a point's identity holds its model's path as the sweep file gives it.
    file.write(
        fmt::format("#!/bin/sh\n"
                    "#SBATCH --job-name=rtusim-sweep\n"
                    "#SBATCH --array=0-{}\n"
                    "#SBATCH --ntasks=1\n"
                    "#SBATCH --output=/dev/null\n"
                    "cd {} || exit 2\n"
                    "exec {} sweep {} --out {} --share \"$SLURM_ARRAY_TASK_ID/{}\" --quiet >{}/slurm-\"$SLURM_ARRAY_TASK_ID\".log 2>&1\n",
                    tasks - 1, shell_quoted(fs::current_path().string()), shell_quoted(program.string()), shell_quoted(o.file.string()),
                    shell_quoted(folder.path().string()), tasks, shell_quoted(folder.path().string())));
    file.commit();
  }
  if (std::system("command -v sbatch >/dev/null 2>&1") != 0)
    throw input_error("--engine slurm", "no sbatch on PATH", fmt::format("Slurm, or {} submitted where there is one", script.string()));
  const std::string command =
      fmt::format("sbatch --wait {} >{} 2>&1", shell_quoted(script.string()), shell_quoted((folder.path() / "slurm.log").string()));
  if (!o.quiet) fmt::print(stderr, "{} points in a Slurm array of {} tasks\n", missing, tasks);
  const int status = std::system(command.c_str());
  if (status != 0) {
    std::string said = config::read_file(folder.path() / "slurm.log");
    said.erase(said.find_last_not_of('\n') + 1);
    if (WIFSIGNALED(status))
      throw simulation_error("sweep: interrupted; the array goes on (" + said + "), and the same command gathers it");
    // Tasks whose points fail end with an error, too; those points are rows with their reasons.
    if (said.find("Submitted batch job") == std::string::npos) throw input_error("sbatch", said, "a Slurm that takes jobs");
  }
}

}  // namespace

void sweep(const sweep_options& o) {
  const auto begin = wall_clock::now();
  const share mine(o.share);
  const sweep_plan plan(o.file);
  const fs::path out = o.out.empty() ? fs::path("out") / o.file.stem() : o.out;
  const results_folder folder(out, plan.images());
  const std::vector<task> tasks = tasks_of(plan);

  std::vector<const task*> missing;
  for (const task& t : tasks)
    if (t.number % mine.of == mine.number && !folder.has(t)) missing.push_back(&t);
  for (const task* t : missing) {
    std::error_code ignored;
    fs::remove(folder.failure(*t), ignored);
  }
  if (!missing.empty()) {
    if (o.how == sweep_options::engine::slurm)
      submit_to_slurm(o, folder, missing.size());
    else
      run_missing(plan, tasks, missing, folder, o);
  }
  if (!o.share.empty()) return;
  const std::size_t failed = gather(plan, tasks, folder);
  if (o.quiet) return;
  fmt::print("{} points{}: {} run now, {} there before{}, in {:.2f} s\n{}\n{}\n", tasks.size(),
             plan.left_out() != 0 ? fmt::format(" ({} left out by constraints)", plan.left_out()) : "", missing.size(),
             tasks.size() - missing.size(), failed != 0 ? fmt::format(", {} failed", failed) : "",
             std::chrono::duration<double>(wall_clock::now() - begin).count(), (out / "results.csv").string(),
             (out / "results.json").string());
}

}  // namespace rtusim
