#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <sstream>
#include <thread>

#include "../command.h"
#include "../output_file.h"
#include "engine.h"
#include "interrupt.h"
#include "run_job.h"
#include "slurm_commands.h"
#include "version.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

// A shared file system may show a file later to others than to who wrote it.
constexpr auto kGrace = std::chrono::seconds(10);
// How often Slurm is asked: at first each second, seldom later, so that its server has peace.
constexpr double kAskShare = 0.02, kAskLeast_s = 1.0, kAskMost_s = 15.0;
constexpr auto kSilence = std::chrono::seconds(60);  // without an answer, until it is said

/// Arrays are known again by their names: of the batch's folder, and numbered.
std::string array_name(const fs::path& out, std::size_t number) {
  return fmt::format("softarm_{}_{}", sha256_of_text(fs::canonical(out).string()).substr(0, 12), number);
}

/// What an array is made of: which job each of its indices is.
fs::path list_path(const fs::path& out, std::size_t number) {
  return out / "slurm" / fmt::format("array_{}.txt", number);
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::istringstream text(read_text(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The arrays that were ever submitted for this batch, by name.
std::map<std::string, std::vector<std::string>> known_arrays(const fs::path& out) {
  std::map<std::string, std::vector<std::string>> arrays;
  std::error_code error;
  for (std::size_t number = 1; fs::is_regular_file(list_path(out, number), error); ++number)
    arrays[array_name(out, number)] = lines_of(list_path(out, number));
  return arrays;
}

std::vector<std::string> keys_of(const std::map<std::string, std::vector<std::string>>& arrays) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : arrays) keys.push_back(key);
  return keys;
}

/// The batch's jobs in Slurm: which task each of them is, and since when none.
class SlurmBatch {
 public:
  explicit SlurmBatch(const Run& run) : run_(run), arrays_(known_arrays(run.out)) {
    for (std::size_t i = 0; i < run.jobs.size(); ++i) open_[run.jobs[i].name()] = {i, "", 0, false, {}};
  }

  /// What an earlier run has left in the queue is not submitted again.
  void take_over() {
    std::string error;
    const auto queue = slurm_queue(keys_of(arrays_), error);
    if (!queue) throw Failure(fmt::format("--engine slurm: Slurm does not answer: {}", error));
    std::size_t taken = 0;
    for (const SlurmTask& task : *queue) taken += note(task) ? 1 : 0;
    if (taken > 0)
      run_.say(
          fmt::format("{} jobs of an earlier run are still in Slurm's queue; going on with them", taken));
  }

  void submit() {
    std::vector<std::string> names;
    for (const JobFolder& job : run_.jobs)
      if (open_.at(job.name()).array_id.empty()) {
        job.clear();
        names.push_back(job.name());
      }
    const std::size_t limit = slurm_array_limit();
    std::string previous;
    for (std::size_t begin = 0; begin < names.size(); begin += limit) {
      const std::size_t end = std::min(begin + limit, names.size());
      previous = submit({names.begin() + static_cast<std::ptrdiff_t>(begin),
                         names.begin() + static_cast<std::ptrdiff_t>(end)},
                        previous);
    }
  }

  void wait() {
    const Clock::time_point begun = Clock::now();
    Clock::time_point answered = begun;
    while (!open_.empty() && signal_kept() == 0) {
      std::string error;
      const Clock::time_point now = Clock::now();
      if (const auto queue = slurm_queue(keys_of(arrays_), error)) {
        answered = now;
        look(*queue);
      } else if (now - answered > kSilence) {
        answered = now;
        run_.say(fmt::format("softarm: warning: Slurm does not answer: {}; waiting for it", error));
      }
      const double since_s = std::chrono::duration<double>(now - begun).count();
      const Clock::time_point next =
          Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                             std::clamp(kAskShare * since_s, kAskLeast_s, kAskMost_s)));
      while (!open_.empty() && signal_kept() == 0 && Clock::now() < next)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  void cancel() const {
    std::set<std::string> ids;
    for (const auto& [name, open] : open_)
      if (!open.array_id.empty()) ids.insert(open.array_id);
    cancel_arrays({ids.begin(), ids.end()});
  }

  std::size_t open() const { return open_.size(); }

 private:
  struct Open {
    std::size_t job = 0;
    std::string array_id;
    std::size_t index = 0;
    bool began = false;  ///< it was seen to run
    std::optional<Clock::time_point> gone_since;
  };

  /// @return whether the task is a job that is waited for
  bool note(const SlurmTask& task) {
    const auto array = arrays_.find(task.array_name);
    if (array == arrays_.end() || task.index >= array->second.size()) return false;
    const auto open = open_.find(array->second[task.index]);
    if (open == open_.end()) return false;
    open->second.array_id = task.array_id;
    open->second.index = task.index;
    if (task.state != "PD" && !open->second.began) {
      open->second.began = true;
      run_.on_begin(open->second.job);
    }
    open->second.gone_since.reset();
    return true;
  }

  std::string submit(const std::vector<std::string>& names, const std::string& previous) {
    const std::size_t number = arrays_.size() + 1;
    std::error_code error;
    fs::create_directories(run_.out / "slurm", error);
    const fs::path list = list_path(run_.out, number),
                   script = run_.out / "slurm" / fmt::format("array_{}.sh", number);
    write_text(
        script,
        fmt::format("#!/bin/sh\nexec {} batch run-job {} {} \"$SLURM_ARRAY_TASK_ID\" --threads {}\n",
                    quoted(run_.program), quoted(run_.out.string()), quoted(list.string()), threads()));
    // The list is there before the array is: who finds the array later knows what it is made of.
    OutputFile file(list);
    file.write(fmt::format("{}\n", fmt::join(names, "\n")));
    file.commit();
    const std::string name = array_name(run_.out, number);
    std::vector<std::string> words{
        fmt::format("--array=0-{}{}", names.size() - 1,
                    run_.at_a_time != 0 ? fmt::format("%{}", run_.at_a_time) : ""),
        "--job-name=" + name, fmt::format("--cpus-per-task={}", threads()), "--requeue",
        fmt::format("--output={}", (run_.out / "slurm" / fmt::format("array_{}_%a.log", number)).string())};
    // As many at a time as was asked for, not as many of each array.
    if (run_.at_a_time != 0 && !previous.empty()) words.push_back("--dependency=afterany:" + previous);
    words.insert(words.end(), run_.slurm_options.begin(), run_.slurm_options.end());
    words.push_back(script.string());
    const std::string id = submit_array(words);
    arrays_[name] = names;
    for (std::size_t i = 0; i < names.size(); ++i) note({name, id, i, "PD", ""});
    run_.say(fmt::format("{} jobs are array {} of Slurm", names.size(), id));
    return id;
  }

  unsigned threads() const { return run_.threads != 0 ? run_.threads : 1; }

  void look(const std::vector<SlurmTask>& queue) {
    std::set<std::string> in_queue;
    std::map<std::string, std::size_t> waiting;
    for (const SlurmTask& task : queue) {
      if (!note(task)) continue;
      in_queue.insert(arrays_.at(task.array_name)[task.index]);
      if (task.state == "PD") ++waiting[task.reason];
    }
    std::string why;
    for (const auto& [reason, count] : waiting)
      why += fmt::format("{}{} waiting{}", why.empty() ? "" : ", ", count,
                         reason.empty() || reason == "None" ? "" : fmt::format(" ({})", reason));
    run_.on_waiting(why);
    run_.on_tick();
    for (auto open = open_.begin(); open != open_.end();) {
      const bool ended = in_queue.count(open->first) == 0 && end_of(open->second);
      open = ended ? open_.erase(open) : std::next(open);
    }
  }

  /// Of a job that is not in the queue any more: whether it has ended, one way or another.
  bool end_of(Open& open) {
    const JobFolder& folder = run_.jobs[open.job];
    if (const std::optional<Outcome> outcome = folder.outcome()) {
      run_.on_end(open.job, *outcome);
      return true;
    }
    const Clock::time_point now = Clock::now();
    if (!open.gone_since) open.gone_since = now;
    if (now - *open.gone_since < kGrace) return false;
    Outcome lost;
    lost.version = program_version();
    const std::string said = slurm_end(open.array_id, open.index);
    lost.reason = !said.empty() ? "Slurm: " + said  // it forgets at once what was taken back before it began
                  : open.began  ? "Slurm ended it, and no longer knows why"
                                : "Slurm never started it: it was cancelled";
    if (const std::optional<Job> job = folder.order()) {
      lost.order_sha256 = digest_of(*job);
      try {
        lost.inputs = note_inputs(*job);
      } catch (const Failure&) {  // a bag that is gone is not why
      }
    }
    folder.write_outcome(lost);
    run_.on_end(open.job, lost);
    return true;
  }

  const Run& run_;
  std::map<std::string, std::vector<std::string>> arrays_;  // names of their jobs, by their own
  std::map<std::string, Open> open_;                        // by the job's name
};

}  // namespace

void run_slurm(const Run& run) {
  SlurmBatch batch(run);
  batch.take_over();
  batch.submit();
  if (!run.wait) return;
  batch.wait();
  if (batch.open() == 0 || signal_kept() == 0) return;
  if (signal_kept() == SIGHUP) return;  // the terminal went; the jobs go on
  batch.cancel();
}

std::size_t left_in_slurm(const fs::path& out) {
  std::string error;
  const std::map<std::string, std::vector<std::string>> arrays = known_arrays(out);
  const auto queue = slurm_queue(keys_of(arrays), error);
  return queue ? queue->size() : 0;
}

}  // namespace softarm::app::batch
