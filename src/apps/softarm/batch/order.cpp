#include "order.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <optional>
#include <utility>

#include "../command.h"
#include "../output_file.h"
#include "../output_lock.h"
#include "../progress.h"
#include "../shipped.h"
#include "course.h"
#include "engine.h"
#include "interrupt.h"
#include "math/parallel.h"
#include "slurm_commands.h"
#include "table.h"

namespace softarm::app::batch {
namespace {

namespace fs = std::filesystem;

constexpr int kInterrupted = 130;

/// The folder is a batch's, of this command, and nobody else writes into it.
class BatchFolder {
 public:
  BatchFolder(const fs::path& out, const std::string& work) {
    std::error_code error;
    const fs::path note = out / "batch.txt";
    const bool fresh = !fs::exists(out, error) || fs::is_empty(out, error);
    if (!fresh && !fs::is_regular_file(note, error))
      throw Failure(
          fmt::format("--out {}: exists already and is not a batch, expected a new or empty folder, or that "
                      "of an earlier batch",
                      out.string()));
    if (!fresh && read_text(note) != note_of(work))
      throw Failure(fmt::format("--out {}: is another command's batch: {}", out.string(), read_text(note)));
    fs::create_directories(out, error);
    if (error) throw Failure(fmt::format("--out {}: cannot be made: {}", out.string(), error.message()));
    lock_.emplace(out / ".lock", fmt::format("--out {}: another batch is running there", out.string()));
    OutputFile file(note);
    file.write(note_of(work));
    file.commit();
  }

 private:
  static std::string note_of(const std::string& work) { return fmt::format("softarm batch {}\n", work); }
  std::optional<OutputLock> lock_;
};

/// The jobs that are to be run, out of all.
struct Plan {
  std::vector<JobFolder> folders;  ///< of all jobs
  std::vector<std::size_t> todo;
  std::size_t done = 0, failed = 0, changed = 0;
};

Plan make_plan(const Order& order) {
  Plan plan;
  plan.folders = find_folders(order.out / "jobs", order.jobs, order.options.force);
  std::vector<Standing> standing(order.jobs.size());
  {
    Progress progress("jobs");  // a bag whose time has changed is read again
    progress.add_total(static_cast<double>(order.jobs.size()));
    progress.doing("looking at what is done");
    math::in_parallel(order.jobs.size(), 0, [&](std::size_t i) {
      standing[i] = plan.folders[i].standing(order.jobs[i]);
      progress.advance(1.0, 1);
    });
  }
  for (std::size_t i = 0; i < order.jobs.size(); ++i) {
    const Standing now = standing[i];
    plan.done += now == Standing::kDone;
    plan.changed += now == Standing::kChanged;
    plan.failed += now == Standing::kFailed && !order.options.retry_failed;
    if (now == Standing::kDone || (now == Standing::kFailed && !order.options.retry_failed)) continue;
    plan.todo.push_back(i);
  }
  return plan;
}

/// What a job costs goes by how much is to be read.
double weight_of(const Job& job) {
  double bytes = 1e5;
  std::error_code error;
  for (const std::string& bag : job.bags) {
    const auto size = fs::file_size(bag, error);
    if (!error) bytes += static_cast<double>(size);
  }
  return bytes;
}

/// What is shown while jobs run: a line for each that ends, and the bar. Thread-safe.
class Shown {
 public:
  Shown(const Order& order, const Plan& plan) : order_(order), plan_(plan), course_(weights(order, plan)) {
    for (const double weight : weights(order, plan)) progress_.add_total(weight);
    tick();
  }
  void begin(std::size_t k) {
    const std::lock_guard<std::mutex> lock(mutex_);
    course_.begin(k, now_s());
  }
  void end(std::size_t k, const Outcome& outcome) {
    const std::size_t i = plan_.todo[k];
    const TableRow row = row_of(order_.jobs[i], plan_.folders[i]);
    say(fmt::format("{:<7}{}: {}", row.state, row.name, outcome.done ? headline(row.figures) : row.reason));
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      course_.end(k, now_s());
      failed_ += row.state == "failed";
    }
    tick();
  }
  void waiting(const std::string& why) {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_ = why;
  }
  void say(const std::string& line) { progress_.line(line); }
  void tick() {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_.doing(fmt::format("{} of {} jobs{}{}", course_.ended(), plan_.todo.size(),
                                failed_ > 0 ? fmt::format(", {} failed", failed_) : "",
                                waiting_.empty() ? "" : ", " + waiting_));
    const double done = course_.done(now_s());
    progress_.advance(done - shown_, 0);
    shown_ = done;
  }

 private:
  static std::vector<double> weights(const Order& order, const Plan& plan) {
    std::vector<double> weights;
    for (const std::size_t i : plan.todo) weights.push_back(weight_of(order.jobs[i]));
    return weights;
  }
  static double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  const Order& order_;
  const Plan& plan_;
  Progress progress_{""};
  std::mutex mutex_;
  Course course_;
  std::size_t failed_ = 0;
  std::string waiting_;
  double shown_ = 0.0;
};

void run_jobs(const Order& order, const Plan& plan) {
  Run run;
  run.out = order.out;
  run.program = order.program;
  run.at_a_time = order.options.jobs;
  run.threads = order.options.threads;
  run.slurm_options = shell_words(order.options.slurm_options, "--slurm-options: ");
  run.wait = !order.options.no_wait;
  for (const std::size_t i : plan.todo) {
    const JobFolder& folder = plan.folders[i];
    const std::optional<Job> before = folder.order();
    if (!before || !(*before == order.jobs[i])) folder.write_order(order.jobs[i]);
    run.jobs.push_back(folder);
  }
  Shown shown(order, plan);
  run.on_begin = [&](std::size_t k) { shown.begin(k); };
  run.on_end = [&](std::size_t k, const Outcome& outcome) { shown.end(k, outcome); };
  run.on_tick = [&] { shown.tick(); };
  run.on_waiting = [&](const std::string& why) { shown.waiting(why); };
  run.say = [&](const std::string& line) { shown.say(line); };
  if (order.options.engine == "slurm")
    run_slurm(run);
  else
    run_local(run);
}

/// @throws Failure where they are not installed: before the work, not after it
report::PageFiles find_page_files() {
  report::PageFiles files;
  for (const std::string& folder : config_folders("report")) {
    std::error_code error;
    if (files.empty() && fs::is_regular_file(fs::path(folder) / "table.html", error))
      files = report::read_table_page_files(folder);
  }
  if (files.empty()) throw Failure("report/table.html: not found; install softarm_estimator again");
  return files;
}

/// Writes the table. @return its rows
std::vector<TableRow> gather(const Order& order, const Plan& plan, const report::PageFiles& files) {
  std::vector<TableRow> rows;
  for (std::size_t i = 0; i < order.jobs.size(); ++i) rows.push_back(row_of(order.jobs[i], plan.folders[i]));
  OutputFile csv(order.out / "batch.csv"), page(order.out / "batch.html");
  csv.write(to_csv(rows));
  page.write(report::to_html(
      table_page(order.work, rows, fmt::format("softarm {} batch {}", SOFTARM_VERSION, order.work)), files));
  csv.commit();
  page.commit();
  return rows;
}

/// The last lines, and the exit status.
int conclude(const Order& order, const std::vector<TableRow>& rows) {
  std::size_t done = 0, open = 0, serious = 0;
  for (const TableRow& row : rows) {
    done += row.state == "done";
    open += row.state == "open";
    serious += std::any_of(row.figures.begin(), row.figures.end(), [](const Figure& figure) {
      return figure.column == "worst" && figure.text == "serious";
    });
  }
  const std::size_t failed = rows.size() - done - open;
  fmt::print("{} jobs: {} done{}{}\n", rows.size(), done,
             failed > 0 ? fmt::format(", {} failed", failed) : "",
             open > 0 ? fmt::format(", {} open", open) : "");
  for (const TableRow& row : rows)
    if (row.state == "failed") fmt::print("failed {}: {}\n", row.name, row.reason);
  if (serious > 0) fmt::print("serious findings in {} of {} recordings\n", serious, rows.size());
  fmt::print("written: {}, {}\n", (order.out / "batch.csv").string(), (order.out / "batch.html").string());
  std::fflush(stdout);
  if (signal_kept() != 0 && open > 0) {
    fmt::print(stderr, "softarm: interrupted; the same command goes on from here\n");
    return kInterrupted;
  }
  if (failed > 0)
    fmt::print(stderr,
               "softarm: {} of {} jobs failed; once the cause is removed, --retry-failed runs them again\n",
               failed, rows.size());
  return failed > 0 || serious > 0 ? 1 : 0;
}

}  // namespace

void run(Order order) {
  const bool slurm = order.options.engine == "slurm";
  if (!slurm && (!order.options.slurm_options.empty() || order.options.no_wait))
    throw Failure("--slurm-options and --no-wait are for --engine slurm", 2);
  if (slurm) require_slurm();
  const report::PageFiles page = find_page_files();
  order.out = fs::absolute(order.options.out).lexically_normal();
  const BatchFolder folder(order.out, order.work);
  keep_signals();
  if (const std::size_t left = slurm ? 0 : left_in_slurm(order.out); left > 0)
    throw Failure(
        fmt::format("--out {}: {} of its jobs are still in Slurm's queue; go on with --engine slurm, or "
                    "cancel them with scancel",
                    order.out.string(), left));
  const Plan plan = make_plan(order);
  fmt::print(
      stderr, "{} jobs: {} to do{}{}{}\n", order.jobs.size(), plan.todo.size(),
      plan.done > 0 ? fmt::format(", {} done before", plan.done) : "",
      plan.changed > 0 ? fmt::format(", {} of them again: what they read has changed", plan.changed) : "",
      plan.failed > 0 ? fmt::format(", {} failed before (--retry-failed runs them again)", plan.failed) : "");
  if (!plan.todo.empty()) run_jobs(order, plan);
  const int status = conclude(order, gather(order, plan, page));
  if (status != 0) throw Ended(status);
}

}  // namespace softarm::app::batch
