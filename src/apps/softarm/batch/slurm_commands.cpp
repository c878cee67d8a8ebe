#include "slurm_commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <sstream>

#include "../command.h"
#include "child.h"
#include "run_job.h"

namespace softarm::app::batch {
namespace {

constexpr std::size_t kUsualArrayLimit = 1001;  // Slurm's own default of MaxArraySize; indices stay below it

// Everything from which a task goes on by itself or is let go on; without this squeue leaves out some of
// them.
constexpr const char* kAlive =
    "--states=PENDING,CONFIGURING,RUNNING,COMPLETING,SUSPENDED,STOPPED,RESIZING,SIGNALING,STAGE_OUT,REQUEUED,"
    "REQUEUE_HOLD,REQUEUE_FED,SPECIAL_EXIT";

bool is_number(const std::string& text) {
  return !text.empty() && text.size() < 12 &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The value of KEY=VALUE among words.
std::string value_of(const std::string& text, const std::string& key) {
  std::istringstream words(text);
  std::string word;
  while (words >> word)
    if (boost::starts_with(word, key + "=")) return word.substr(key.size() + 1);
  return "";
}

}  // namespace

void require_slurm() {
  for (const char* program : {"sbatch", "squeue", "scancel", "scontrol"})
    if (on_path(program).empty())
      throw Failure(
          fmt::format("--engine slurm: no {} on PATH; it is part of Slurm (Debian: slurm-client)", program),
          2);
  slurm_array_limit();
}

std::vector<SlurmTask> parse_queue(const std::string& lines) {
  std::vector<SlurmTask> tasks;
  std::istringstream text(lines);
  std::string line;
  while (std::getline(text, line)) {
    std::vector<std::string> cells;
    boost::split(cells, line, [](char c) { return c == '|'; });
    if (cells.size() < 5) continue;
    for (std::string& cell : cells) boost::trim(cell);
    if (!is_number(cells[1]) || !is_number(cells[2])) continue;
    tasks.push_back({cells[0], cells[1], std::stoul(cells[2]), cells[3], cells[4]});
  }
  return tasks;
}

std::optional<std::vector<SlurmTask>> slurm_queue(const std::vector<std::string>& array_names,
                                                  std::string& error) {
  if (array_names.empty()) return std::vector<SlurmTask>{};
  std::string lines;
  const std::string squeue = on_path("squeue");
  if (squeue.empty()) {
    error = "no squeue on PATH";
    return std::nullopt;
  }
  if (!run_and_read({squeue, "--noheader", "--array", kAlive,
                     fmt::format("--name={}", fmt::join(array_names, ",")), "--format=%j|%F|%K|%t|%r"},
                    lines, error)) {
    error = as_one_line(error);
    return std::nullopt;
  }
  return parse_queue(lines);
}

std::size_t slurm_array_limit() {
  std::string shown, error;
  if (!run_and_read({on_path("scontrol"), "show", "config"}, shown, error))
    throw Failure(fmt::format("--engine slurm: Slurm does not answer: {}", as_one_line(error)));
  std::istringstream lines(shown);
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t equal = line.find('=');
    if (!boost::starts_with(line, "MaxArraySize") || equal == std::string::npos) continue;
    const std::string value = boost::trim_copy(line.substr(equal + 1));
    if (is_number(value) && std::stoul(value) > 1) return std::stoul(value) - 1;
  }
  return kUsualArrayLimit - 1;
}

std::string submit_array(const std::vector<std::string>& sbatch_words) {
  std::vector<std::string> words{on_path("sbatch"), "--parsable"};
  words.insert(words.end(), sbatch_words.begin(), sbatch_words.end());
  std::string said, error;
  if (!run_and_read(words, said, error))
    throw Failure(fmt::format("--engine slurm: sbatch accepted no job: {}", as_one_line(error)));
  std::istringstream lines(said);
  std::string line, id;
  while (std::getline(lines, line)) {
    const std::string first = boost::trim_copy(line.substr(0, line.find(';')));  // "12;cluster"
    if (is_number(first)) id = first;
  }
  if (id.empty())
    throw Failure(fmt::format("--engine slurm: sbatch returned no job number: {}", as_one_line(said)));
  return id;
}

void cancel_arrays(const std::vector<std::string>& ids) {
  std::vector<std::string> words{on_path("scancel"), "--quiet"};
  words.insert(words.end(), ids.begin(), ids.end());
  std::string said, error;
  if (!ids.empty() && !run_and_read(words, said, error))
    throw Failure(fmt::format("the jobs could not be cancelled: {}", as_one_line(error)));
}

std::string parse_end(const std::string& shown) {
  const std::string state = value_of(shown, "JobState"), reason = value_of(shown, "Reason");
  if (state.empty()) return "";
  std::string text = state;
  if (!reason.empty() && reason != "None") text += fmt::format(" ({})", reason);
  const std::string code = value_of(shown, "ExitCode");
  if (!code.empty() && code != "0:0") text += fmt::format(", exit code {}", code);
  return text;
}

std::string slurm_end(const std::string& array_id, std::size_t index) {
  std::string shown, error;
  if (!run_and_read({on_path("scontrol"), "--oneliner", "show", "job", fmt::format("{}_{}", array_id, index)},
                    shown, error))
    return "";
  return parse_end(shown);
}

}  // namespace softarm::app::batch
