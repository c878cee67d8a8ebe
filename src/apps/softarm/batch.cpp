// softarm batch: estimate, diagnose or check over lists of trials, in processes of this machine or as jobs of
// Slurm.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "batch/interrupt.h"
#include "batch/job_list.h"
#include "batch/order.h"
#include "batch/run_job.h"
#include "command.h"
#include "output_file.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;
using batch::Job;
using batch::JobFolder;
using batch::Order;

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

/// Commands that are read, not run: a callback that is taken away would take with it what the options are
/// kept in.
class ReadOnly : public CLI::App {
 public:
  /// @throws CLI::ParseError
  void read(std::vector<std::string> words) {
    std::reverse(words.begin(), words.end());
    try {
      parse(std::move(words));
    } catch (const Read&) {
    }
  }

 private:
  struct Read {};
  void pre_callback() override { throw Read(); }
};

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
    ReadOnly program;
    add_check(program);
    add_diagnose(program);
    add_estimate(program);
    try {
      program.read(words);
    } catch (const CLI::ParseError& error) {
      throw Failure(error.what(), 2);
    }
  }
}

void start_batch(const std::string& work, const WorkOptions& typed, const batch::OrderOptions& options,
                 const std::map<std::string, bool>& has_value) {
  Order order{work, options, {}, {}, own_path()};
  std::map<std::string, std::string> arms;
  order.jobs = batch::list_jobs(
      {work, typed.arm, typed_words(typed), typed.inputs, has_value,
       [&](const std::string& arm, const std::string& folder) { return find_arm(arm, folder, arms); }});
  try_options(order.jobs);
  batch::run(std::move(order));
}

void add_work(CLI::App& batch_command, const CLI::App& command,
              const std::shared_ptr<batch::OrderOptions>& options) {
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
  const auto options = std::make_shared<batch::OrderOptions>();
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
                    "repeat jobs that were done with another arm file or other options");
  command->add_option("--slurm-options", options->slurm_options,
                      "handed to sbatch: '--partition=long --mem=4G --time=1:00:00'");
  command->add_flag("--no-wait", options->no_wait,
                    "Slurm: end once the jobs are in its queue; the same command gathers the results");
  for (const char* work : {"estimate", "diagnose", "check"})
    add_work(*command, *program.get_subcommand(work), options);
  add_run_job(*command);
  command->footer(kBatchExamples);
}

}  // namespace softarm::app
