// softarm batch: estimate, diagnose or check over lists of trials, in processes of this machine or as jobs of
// Slurm.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "batch/course.h"
#include "batch/engine.h"
#include "batch/interrupt.h"
#include "batch/job_list.h"
#include "batch/run_job.h"
#include "batch/slurm_commands.h"
#include "batch/table.h"
#include "command.h"
#include "math/parallel.h"
#include "output_file.h"
#include "output_lock.h"
#include "progress.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;
using batch::Job;
using batch::JobFolder;
using batch::Standing;
using batch::TableRow;

constexpr int kInterrupted = 130;

struct BatchOptions {
  std::string engine = "local", out = "batch";
  unsigned jobs = 0, threads = 0;
  bool retry_failed = false, force = false, no_wait = false;
  std::string slurm_options;
};

/// What is typed behind `softarm batch estimate`: the command's own options, as words.
struct WorkOptions {
  std::string arm;
  std::vector<std::string> inputs;
  std::map<std::string, std::vector<std::string>> values;
  std::map<std::string, bool> flags;
};

constexpr const char* kBatchExamples = R"(Examples:
  softarm batch estimate --arm my_arm.yaml trials --out estimates       a job for each bag in the folder
  softarm batch check --arm my_arm.yaml 'trials/*/*.bag' --out checks   a pattern, in quotes
  softarm batch diagnose --arm my_arm.yaml trials --out diagnoses       a job for each folder with bags
  softarm batch diagnose list.yaml --out diagnoses                      each job with its own arm file, bags and options
  softarm batch --engine slurm --slurm-options '--mem=4G --time=1:00:00' diagnose list.yaml --out diagnoses
A list is text, a job a line as it would stand behind the command:
  --arm arms/a.yaml monday/*.bag
  --arm arms/b.yaml tuesday --payload 0.2
or YAML; paths are relative to it:
  arm: my_arm.yaml
  jobs:
    - bags: monday
    - {name: tuesday, arm: other.yaml, bags: [a.bag, b.bag, c.bag], options: --payload 0.2}
What is written:
  batch/batch.csv, batch/batch.html   the results of all jobs: a line each
  batch/jobs/<job>/                   of each job its result, what it said (log.txt) and what it cost (outcome.json)
The same command goes on where the last one ended. A job is done again where its arm file or bags have changed.
Exit status: 0 all done, 1 a job failed, or check found something serious, 2 bad usage, 130 interrupted.)";

/// What a batch as a whole is asked for.
struct Order {
  std::string work;
  BatchOptions options;
  std::vector<Job> jobs;
  fs::path out;
  std::string program;
};

std::string own_path() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw Failure(fmt::format("/proc/self/exe: {}", error.message()));
  return program.string();
}

/// An arm by its file or by its shipped name; each is read once, so that a bad one is said before all jobs.
std::string find_arm(const std::string& arm, const std::string& folder,
                     std::map<std::string, std::string>& known) {
  std::error_code error;
  const fs::path beside = (fs::path(folder) / arm).lexically_normal();
  const std::string name = fs::is_regular_file(beside, error) ? beside.string() : arm;
  const auto found = known.find(name);
  if (found != known.end()) return found->second;
  try {
    arm::load_arm_file(name, config_folders("arms"));
    const std::string source = arm::read_arm_text(name, config_folders("arms")).source;
    return known[name] = fs::absolute(source).lexically_normal().string();
  } catch (const arm::ArmError& why) {
    throw Failure(why.what(), 2);
  }
}

/// The folder is a batch's, of this command, and nobody else writes into it.
class BatchFolder {
 public:
  BatchFolder(const fs::path& out, const std::string& work) {
    std::error_code error;
    const fs::path note = out / "batch.txt";
    const bool fresh = !fs::exists(out, error) || fs::is_empty(out, error);
    if (!fresh && !fs::is_regular_file(note, error))
      throw Failure(fmt::format(
          "--out {}: is there already and is no batch, expected a new or empty folder, or that of "
          "an earlier batch",
          out.string()));
    if (!fresh && read_text(note) != note_of(work))
      throw Failure(fmt::format("--out {}: is another command's batch: {}", out.string(), read_text(note)));
    fs::create_directories(out, error);
    if (error) throw Failure(fmt::format("--out {}: cannot be made: {}", out.string(), error.message()));
    lock_.emplace(out / ".lock", fmt::format("--out {}: another batch is at work there", out.string()));
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
  plan.folders = batch::find_folders(order.out / "jobs", order.jobs, order.options.force);
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
  void end(std::size_t k, const batch::Outcome& outcome) {
    const std::size_t i = plan_.todo[k];
    const TableRow row = batch::row_of(order_.jobs[i], plan_.folders[i]);
    say(fmt::format("{:<7}{}: {}", row.state, row.name,
                    outcome.done ? batch::headline(row.figures) : row.reason));
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
  batch::Course course_;
  std::size_t failed_ = 0;
  std::string waiting_;
  double shown_ = 0.0;
};

void run_jobs(const Order& order, const Plan& plan) {
  batch::Run run;
  run.out = order.out;
  run.program = order.program;
  run.at_a_time = order.options.jobs;
  run.threads = order.options.threads;
  run.slurm_options = batch::shell_words(order.options.slurm_options, "--slurm-options: ");
  run.wait = !order.options.no_wait;
  for (const std::size_t i : plan.todo) {
    const JobFolder& folder = plan.folders[i];
    const std::optional<Job> before = folder.order();
    if (!before || !(*before == order.jobs[i])) folder.write_order(order.jobs[i]);
    run.jobs.push_back(folder);
  }
  Shown shown(order, plan);
  run.on_begin = [&](std::size_t k) { shown.begin(k); };
  run.on_end = [&](std::size_t k, const batch::Outcome& outcome) { shown.end(k, outcome); };
  run.on_tick = [&] { shown.tick(); };
  run.on_waiting = [&](const std::string& why) { shown.waiting(why); };
  run.say = [&](const std::string& line) { shown.say(line); };
  if (order.options.engine == "slurm")
    batch::run_slurm(run);
  else
    batch::run_local(run);
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
  for (std::size_t i = 0; i < order.jobs.size(); ++i)
    rows.push_back(batch::row_of(order.jobs[i], plan.folders[i]));
  OutputFile csv(order.out / "batch.csv"), page(order.out / "batch.html");
  csv.write(batch::to_csv(rows));
  page.write(report::to_html(
      batch::table_page(order.work, rows, fmt::format("softarm {} batch {}", SOFTARM_VERSION, order.work)),
      files));
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
    serious += std::any_of(row.figures.begin(), row.figures.end(), [](const batch::Figure& figure) {
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
  if (batch::signal_kept() != 0 && open > 0) {
    fmt::print(stderr, "softarm: interrupted; the same command goes on from here\n");
    return kInterrupted;
  }
  if (failed > 0)
    fmt::print(stderr, "softarm: {} of {} jobs failed; once mended, --retry-failed runs them again\n", failed,
               rows.size());
  return failed > 0 || serious > 0 ? 1 : 0;
}

void run_batch(Order order) {
  const bool slurm = order.options.engine == "slurm";
  if (!slurm && (!order.options.slurm_options.empty() || order.options.no_wait))
    throw Failure("--slurm-options and --no-wait are for --engine slurm", 2);
  if (slurm) batch::require_slurm();
  const report::PageFiles page = find_page_files();
  order.out = fs::absolute(order.options.out).lexically_normal();
  const BatchFolder folder(order.out, order.work);
  batch::keep_signals();
  if (const std::size_t left = slurm ? 0 : batch::left_in_slurm(order.out); left > 0)
    throw Failure(
        fmt::format("--out {}: {} of its jobs are still in Slurm's queue; go on with --engine slurm, or take "
                    "them back with scancel",
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

/// The options of a command that make sense in a batch; the batch itself says the rest.
std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  static const std::set<std::string> kOfTheBatch{"--help",  "--arm",  "--out",    "--json",
                                                 "--force", "--jobs", "--effects"};
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_lnames().empty() && kOfTheBatch.count("--" + option->get_lnames().front()) == 0)
      options.push_back(option);
  return options;
}

std::vector<batch::Word> typed_words(const WorkOptions& work) {
  std::vector<batch::Word> words;
  for (const auto& [name, values] : work.values)
    for (const std::string& value : values) words.push_back({name, value});
  for (const auto& [name, given] : work.flags)
    if (given) words.push_back({name, std::nullopt});
  return words;
}

/// Says now what every job would say: an option whose value cannot be.
void try_options(const std::vector<Job>& jobs) {
  std::set<std::string> tried;
  for (const Job& job : jobs) {
    std::vector<std::string> words{job.work, "--arm", job.arm, "trial.bag"};
    std::string key;
    for (const batch::Word& option : job.options) {
      words.push_back(option.name);
      if (option.value) words.push_back(*option.value);
      key += option.name + '\0' + option.value.value_or("") + '\0';
    }
    if (!tried.insert(key).second) continue;
    CLI::App program;
    add_check(program);
    add_diagnose(program);
    add_estimate(program);
    for (CLI::App* command : program.get_subcommands({})) command->callback([] {});
    std::reverse(words.begin(), words.end());
    try {
      program.parse(words);
    } catch (const CLI::ParseError& error) {
      throw Failure(error.what(), 2);
    }
  }
}

void start_batch(const std::string& work, const WorkOptions& typed, const BatchOptions& options,
                 const std::map<std::string, bool>& has_value) {
  Order order{work, options, {}, {}, own_path()};
  std::map<std::string, std::string> arms;
  order.jobs = batch::list_jobs(
      {work, typed.arm, typed_words(typed), typed.inputs, has_value,
       [&](const std::string& arm, const std::string& folder) { return find_arm(arm, folder, arms); }});
  try_options(order.jobs);
  run_batch(std::move(order));
}

void add_work(CLI::App& batch_command, const CLI::App& command,
              const std::shared_ptr<BatchOptions>& options) {
  const auto typed = std::make_shared<WorkOptions>();
  const auto has_value = std::make_shared<std::map<std::string, bool>>();
  CLI::App* work = batch_command.add_subcommand(command.get_name(), command.get_description());
  work->fallthrough();
  work->add_option("--arm", typed->arm,
                   "arm file, or the name of one in config/arms, where no list names another");
  work->add_option("INPUT", typed->inputs, "bags, folders, patterns in quotes, or lists (.txt, .yaml)")
      ->required();
  for (const CLI::Option* option : options_of(command)) {
    const std::string name = "--" + option->get_lnames().front();
    const bool value = option->get_items_expected_max() > 0;
    (*has_value)[name] = value;
    if (value)
      work->add_option(name, typed->values[name], option->get_description())
          ->expected(1)
          ->take_all()
          ->allow_extra_args(false)
          ->type_name(option->get_type_name());
    else
      work->add_flag(name, typed->flags[name], option->get_description());
  }
  work->footer("The other options, and examples: softarm batch --help");
  work->callback([=, name = command.get_name()] { start_batch(name, *typed, *options, *has_value); });
}

/// What an array of Slurm runs: the job at a place of a list.
void add_run_job(CLI::App& batch_command) {
  struct Options {
    std::string out, list;
    std::size_t index = 0;
    unsigned threads = 1;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = batch_command.add_subcommand("run-job", "One job of a batch; Slurm calls it.");
  command->group("");  // nobody types it
  command->add_option("OUT", options->out)->required();
  command->add_option("LIST", options->list)->required();
  command->add_option("INDEX", options->index)->required();
  command->add_option("--threads", options->threads);
  command->callback([options] {
    std::istringstream lines(read_text(options->list));
    std::string name;
    for (std::size_t i = 0; i <= options->index; ++i)
      if (!std::getline(lines, name))
        throw Failure(fmt::format("{}: has no line {}", options->list, options->index));
    batch::keep_signals();
    if (!batch::run_job(JobFolder(fs::path(options->out) / "jobs" / name), own_path(), options->threads,
                        [] { return batch::signal_kept() != 0; }))
      throw Ended(128 + batch::signal_kept());
  });
}

}  // namespace

void add_batch(CLI::App& program) {
  const auto options = std::make_shared<BatchOptions>();
  CLI::App* command = program.add_subcommand(
      "batch", "Estimate, diagnose or check many trials, here or on a cluster; resumable.");
  command->require_subcommand(1);
  command->add_option("--engine", options->engine, "local: processes of this machine; slurm: arrays of Slurm")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  command->add_option("--out", options->out, "folder of the batch")->capture_default_str();
  command
      ->add_option("--jobs", options->jobs,
                   "jobs at a time (default: one per processor; Slurm: what it gives)")
      ->check(CLI::Range(1U, 100000U));
  command
      ->add_option("--threads", options->threads, "processors of each job (default: what is left; Slurm: 1)")
      ->check(CLI::Range(1U, 256U));
  command->add_flag("--retry-failed", options->retry_failed, "run jobs again that failed before");
  command->add_flag("--force", options->force,
                    "do jobs anew that are there with another arm file or other options");
  command->add_option("--slurm-options", options->slurm_options,
                      "handed to sbatch: '--partition=long --mem=4G --time=1:00:00'");
  command->add_flag("--no-wait", options->no_wait,
                    "Slurm: end once the jobs are in its queue; the same command gathers");
  for (const char* work : {"estimate", "diagnose", "check"})
    add_work(*command, *program.get_subcommand(work), options);
  add_run_job(*command);
  command->footer(kBatchExamples);
}

}  // namespace softarm::app
