#include "testbench/commands/sweep_command.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "modules/config/durable.h"
#include "modules/config/error.h"
#include "modules/config/files.h"
#include "modules/config/input_ledger.h"
#include "testbench/commands/options.h"
#include "testbench/pictures/picture_library.h"
#include "testbench/pictures/pictures.h"
#include "testbench/run/interrupts.h"
#include "testbench/run/procedure.h"
#include "testbench/run/progress_line.h"
#include "testbench/run/record_paths.h"
#include "testbench/run/run_pictures.h"
#include "testbench/run/run_setup.h"
#include "testbench/run/summary.h"
#include "testbench/sweep/results_folder.h"
#include "testbench/sweep/sweep_identity.h"
#include "testbench/sweep/sweep_plan.h"
#include "testbench/sweep/sweep_slurm.h"
#include "testbench/sweep/sweep_tables.h"
#include "testbench/sweep/worker_pool.h"

namespace rtusim {
namespace {

using wall_clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

/// Of all that a sweep reads; beyond, a model is read a second time when its points are run, and must be the same.
constexpr std::uint64_t most_kept_bytes = std::uint64_t{1} << 29;

/// The rays of one walk, or why there are none.
struct loaded_rays {
  std::unique_ptr<run_inputs> rays;
  point_failure failure;

  loaded_rays() = default;
  loaded_rays(const sweep_plan& plan, const sweep_task& t) {
    const auto s = plan.setup(*t.point);
    const config::input_ledger read;
    try {
      rays = std::make_unique<run_inputs>(*s, "", 1, !plan.images().empty());
      rays->walk(*s, 1);
    } catch (const std::bad_alloc&) {
      failure.reason = "out of memory";
    } catch (const input_error& e) {
      failure.reason = plan.named_as_written(e.what());
    } catch (const simulation_error& e) {
      failure.reason = e.what();
    }
    if (const std::string file = changed_input(t.inputs, read.files(), rays != nullptr); !file.empty()) {
      rays.reset();
      failure = {plan.named_as_written(file) + " changed while the sweep ran", false};
    }
  }
};

/// Runs a point, in a worker's process, and leaves its files in the part of the folder that is its own.
worker_report run_point(const sweep_plan& plan, const sweep_task& t, const run_inputs& shared, const results_folder& folder) {
  const auto begin = wall_clock::now();
  const auto s = plan.setup(*t.point);
  RTU_CHECK(identity_of(*s, t.inputs), ==, t.identity);
  shared.model->settle(s->hardware);
  std::optional<run_pictures> shown;
  run_manner manner;
  manner.pace = shared.walked ? quickest_pace(*s) : run_pace::skipping;
  if (!plan.images().empty()) {
    shown.emplace(*s, *shared.model, shared.sent.packets, true);
    manner.each = [&](cycle, const traversal_result& r, std::uint64_t latency_cycles) { shown->store(r, latency_cycles); };
  }
  traced_run run = trace(*s, shared, manner);
  run.speed.all_seconds = std::chrono::duration<double>(wall_clock::now() - begin).count();
  run_record record = record_of(*s, shared, run);
  record.inputs["scene"] = plan.scene(*t.point).string();
  record.inputs["architecture"] = plan.architecture(*t.point).string();
  if (shown)
    shown->finish(run.figures, std::any_of(plan.images().begin(), plan.images().end(),
                                           [](const std::string& ending) { return shows_places(kind_of("image." + ending)); }));
  try {
    const fs::path part = folder.part(t);
    fs::remove_all(part);
    fs::create_directory(part);
    config::write_new_file(part / "stats.json", record_text(std::move(record), folder_of_record(folder.point(t) / "stats.json")));
    const config::deferred_sync batched;  // `point_batch` waits for the disk
    for (const std::string& ending : plan.images()) shown->write(part / ("image." + ending));
    config::write_new_file(part / "identity.json", t.identity);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return {worker_report::outcome::unwritable, e.what()};
  }
  return {};
}

/// How many points are done and how long the rest will take.
class sweep_progress {
 public:
  sweep_progress(bool wanted, std::size_t points) : line_(wanted), points_(points) {}
  void done() {
    ++done_;
    const double spent = std::chrono::duration<double>(wall_clock::now() - begin_).count();
    line_.show(fmt::format("{} of {} points, {:.0f} s left ", done_, points_,
                           spent / static_cast<double>(done_) * static_cast<double>(points_ - done_)));
  }

 private:
  progress_line line_;
  std::size_t points_;
  std::size_t done_ = 0;
  wall_clock::time_point begin_ = wall_clock::now();
};

/// Runs points, those that share their rays one after the other.
class sweep_run {
 public:
  sweep_run(const sweep_plan& plan, const std::vector<sweep_task>& tasks, const results_folder& folder, unsigned workers, bool quiet,
            std::size_t points)
      : plan_(plan), tasks_(tasks), folder_(folder), workers_(workers), batch_(folder), progress_(!quiet, points), pool_(workers) {}

  /// Errors: input_error for results that can't be written; simulation_error when it is interrupted.
  void run(std::vector<const sweep_task*> order) {
    std::map<std::string, std::size_t> first, points;
    for (const sweep_task* t : order) {
      first.emplace(t->walk, t->number);
      ++points[t->walk];
    }
    std::stable_sort(order.begin(), order.end(), [&](const sweep_task* a, const sweep_task* b) { return first[a->walk] < first[b->walk]; });
    loaded_rays shared;
    std::string walk;
    std::set<std::string> started;
    std::vector<std::size_t> together;  // for the next worker
    const auto start = [&] {
      if (together.empty()) return;
      while (pool_.full()) wait();
      pool_.start(std::exchange(together, {}), [&](std::size_t number) { return run_point(plan_, tasks_[number], *shared.rays, folder_); });
    };
    for (const sweep_task* t : order) {
      if (!started.insert(t->name).second) continue;  // the same run as another point
      if (walk != t->walk) {
        start();
        shared = {};
        shared = loaded_rays(plan_, *t);
        walk = t->walk;
      }
      if (!shared.rays) {
        fail(*t, shared.failure);
        continue;
      }
      const std::size_t most = at_once(*t, *shared.rays, points[walk]);
      if (most == 1) start();
      together.push_back(t->number);
      if (together.size() >= most) start();
    }
    start();
    while (!pool_.empty()) wait();
    if (!left_over_.empty()) run(std::exchange(left_over_, {}));
    batch_.commit();
  }

  /// Keeps what has ended.
  void commit() { batch_.commit(); }

 private:
  /// How many points a worker does that has this one to do. SystemC elaborates once a process, a replay does without it; pictures take
  /// longer than a process. Each worker gets several turns, so that they end together.
  std::size_t at_once(const sweep_task& t, const run_inputs& rays, std::size_t points) const {
    constexpr std::size_t most = 16, turns = 4;
    if (!t.replayed || !rays.walked || !plan_.images().empty() || retried_.count(t.number) != 0) return 1;
    return std::clamp<std::size_t>(points / (turns * workers_), 1, most);
  }
  void wait() {
    if (const auto ended = pool_.next(batch_.patience())) settle(tasks_[ended->work], ended->report);
    batch_.commit_if_due();
    if (interrupts::came()) throw simulation_error("interrupted");
  }
  void settle(const sweep_task& t, const worker_report& r) {
    switch (r.how) {
      case worker_report::outcome::done:
        batch_.done(t);
        progress_.done();
        break;
      case worker_report::outcome::failed: fail(t, {plan_.named_as_written(r.reason), true}); break;
      case worker_report::outcome::unwritable:
        throw input_error(folder_.path().string(), fmt::format("a result that could not be written ({})", r.reason), "room on the disk");
      case worker_report::outcome::not_begun:
        retried_.insert(t.number);
        left_over_.push_back(&t);
        break;
    }
  }
  void fail(const sweep_task& t, const point_failure& why) {
    batch_.failed(t, why);
    progress_.done();
    batch_.commit_if_due();
  }

  const sweep_plan& plan_;
  const std::vector<sweep_task>& tasks_;
  const results_folder& folder_;
  unsigned workers_;
  std::vector<const sweep_task*> left_over_;  // by a worker that ended early
  std::set<std::size_t> retried_;
  point_batch batch_;
  sweep_progress progress_;
  worker_pool pool_;
};

void run_missing(const sweep_plan& plan, const std::vector<sweep_task>& tasks, const std::vector<const sweep_task*>& missing,
                 const results_folder& folder, const sweep_options& o) {
  // It takes longer to load than most points to run.
  if (!plan.images().empty() && missing.size() > 1) share_picture_library();
  sweep_run now(plan, tasks, folder, o.jobs, o.quiet, missing.size());
  try {
    now.run(missing);
  } catch (const simulation_error&) {
    if (!interrupts::came()) throw;
    now.commit();
    config::sync_file_system(folder.path());
    const std::size_t done = tasks.size() - failures_of(tasks, folder).size();
    throw simulation_error(fmt::format("sweep: interrupted; {} of {} points are done, and the same command goes on", done, tasks.size()));
  }
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

}  // namespace

void sweep(const sweep_options& o) {
  const auto begin = wall_clock::now();
  const share mine(o.share);
  const interrupts noted;
  const config::input_ledger inputs(config::input_ledger::keeping::bytes, most_kept_bytes);
  const sweep_plan plan(o.file);
  const fs::path out = o.out.empty() ? fs::path("out") / o.file.stem() : o.out;
  results_folder folder(out, plan.images());
  std::vector<sweep_task> tasks = tasks_of(plan);
  if (!o.share.empty())
    tasks.erase(std::remove_if(tasks.begin(), tasks.end(), [&](const sweep_task& t) { return t.number % mine.of != mine.number; }),
                tasks.end());
  for (std::size_t i = 0; i < tasks.size(); ++i) tasks[i].number = i;

  folder.lock(o.share.empty() ? results_folder::use::whole : results_folder::use::shared, !o.quiet);
  std::vector<const sweep_task*> missing;
  std::size_t there = 0;
  for (const sweep_task& t : tasks) {
    if (folder.record(t)) {
      ++there;
    } else if (const auto failed = folder.failure(t); !failed || !failed->kept || (o.retry_failed && t.failure.empty())) {
      folder.forget_failure(t);
      missing.push_back(&t);
    }
  }
  if (!missing.empty() && o.how == sweep_options::engine::slurm) {
    const std::size_t parts = std::min<std::size_t>(missing.size(), o.jobs);
    if (!o.quiet) fmt::print(stderr, "{} points in a Slurm array of {} tasks\n", missing.size(), parts);
    folder.unlock();
    run_slurm_array(o.file, folder, parts);
    folder.lock(results_folder::use::whole, !o.quiet);
  } else if (!missing.empty()) {
    run_missing(plan, tasks, missing, folder, o);
  }

  std::vector<std::string> failures;
  if (o.share.empty()) {
    failures = gather(plan, tasks, folder, o.units);
    if (!o.quiet)
      fmt::print("{} points{}: {} run now, {} there before{}, in {:.2f} s\n{}\n{}\n", tasks.size(),
                 plan.left_out() != 0 ? fmt::format(" ({} left out by constraints)", plan.left_out()) : "", missing.size(), there,
                 failures.empty() ? "" : fmt::format(", {} failed", failures.size()),
                 std::chrono::duration<double>(wall_clock::now() - begin).count(), (out / "results.csv").string(),
                 (out / "results.json").string());
  } else {
    config::sync_file_system(out);
    failures = failures_of(tasks, folder);
  }
  if (failures.empty()) return;
  std::fflush(stdout);
  fmt::print(stderr, "{}", failure_text(failures));
  throw simulation_error(
      fmt::format("sweep: {} of {} points failed; those that were run are run again with --retry-failed", failures.size(), tasks.size()));
}

void add_sweep(CLI::App& program) {
  auto options = std::make_shared<sweep_options>();
  sweep_options& o = *options;
  CLI::App& app = add_command(program, "sweep", "run a hundred designs, and one table of them all", options, sweep);
  app.add_option("SWEEP.toml", o.file, "axes, scenes and what is kept; see testbench/sweeps")->required()->type_name("");
  app.add_option("--out", o.out, "folder of the results; out/SWEEP if left out")->type_name("DIR");
  const auto read_jobs = [&o](const std::string& text) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), o.jobs);
    if (error != std::errc{} || end != text.data() + text.size() || o.jobs < 1 || o.jobs > 4096)
      throw input_error("-j", '"' + text + '"', "a whole number from 1 to 4096");
  };
  app.add_option_function<std::string>("-j", read_jobs, "worker processes, or tasks of the Slurm array")->type_name("N");
  const auto read_engine = [&o](const std::string& word) {
    if (word != "local" && word != "slurm") throw input_error("--engine", '"' + word + '"', "local or slurm");
    o.how = word == "slurm" ? sweep_options::engine::slurm : sweep_options::engine::local;
  };
  app.add_option_function<std::string>("--engine", read_engine, "local processes, or a job array of Slurm")->type_name("ENGINE");
  app.add_option("--share", o.share, "only the points with number modulo N = I, and no table: for one of N machines")->type_name("I/N");
  app.add_flag("--retry-failed", o.retry_failed, "run again what failed before");
  app.add_flag("--units", o.units, "a second header row in results.csv: the columns' units");
  app.add_flag("--quiet", o.quiet, "no summary");
  app.footer("What is done stays: an interrupted sweep goes on with the same command, a changed one runs only what is new.");
}

}  // namespace rtusim
