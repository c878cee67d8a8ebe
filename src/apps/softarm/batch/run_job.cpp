#include "run_job.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <cstring>
#include <sstream>

#include "../command.h"
#include "../output_file.h"
#include "child.h"
#include "version.h"

namespace softarm::app::batch {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestReason = 300;
constexpr const char* kSays = "softarm: ";  // what every error line of the program begins with

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::vector<std::string> command_of(const Job& job, const JobFolder& folder, const std::string& program,
                                    unsigned threads) {
  std::vector<std::string> words{program, job.work, "--arm", job.arm, "--jobs", std::to_string(threads)};
  for (const Word& option : job.options) {
    words.push_back(option.name);
    if (option.value) words.push_back(*option.value);
  }
  if (job.work == "check") {
    words.insert(words.end(), {"--json", (folder.result() / "findings.json").string()});
  } else {
    words.insert(words.end(), {"--out", folder.result().string()});
  }
  words.insert(words.end(), job.bags.begin(), job.bags.end());
  return words;
}

/// Whether the command did what it is for.
bool succeeded(const Job& job, const JobFolder& folder, const ChildEnd& end) {
  std::error_code error;
  // A recording that something spoils is a result of check, not a failure.
  if (job.work == "check")
    return (end.exit_status == 0 || end.exit_status == 1) &&
           fs::exists(folder.result() / "findings.json", error);
  return end.exit_status == 0;
}

std::string why(const JobFolder& folder, const ChildEnd& end) {
  if (end.signal != 0)
    return fmt::format("ended by signal {} ({})", end.signal,
                       end.signal == SIGKILL ? "killed; was there enough memory?" : ::strsignal(end.signal));
  const std::string said = reason_in(read_text(folder.log()));
  return said.empty() ? fmt::format("exit status {}, without a message", end.exit_status) : said;
}

}  // namespace

std::string as_one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  boost::trim(text);
  if (text.size() > kLongestReason) {
    std::size_t cut = kLongestReason;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0U) == 0x80U)
      --cut;  // not within a character
    text = text.substr(0, cut) + "...";
  }
  return text;
}

std::string reason_in(const std::string& log) {
  std::istringstream lines(log);
  std::string line, last, reason;
  while (std::getline(lines, line)) {
    line = line.substr(line.rfind('\r') == std::string::npos ? 0 : line.rfind('\r') + 1);
    if (line.empty()) continue;
    last = line;
    if (!boost::starts_with(line, kSays)) continue;
    line = line.substr(std::strlen(kSays));
    // What else it says under its name.
    const auto other = {"warning: ", "note: ", "effects: "};
    if (std::none_of(other.begin(), other.end(),
                     [&](const char* begin) { return boost::starts_with(line, begin); }))
      reason = line;
  }
  return as_one_line(reason.empty() ? last : reason);
}

std::optional<Outcome> run_job(const JobFolder& folder, const std::string& program, unsigned threads,
                               const std::function<bool()>& stop) {
  const std::optional<Job> job = folder.order();
  if (!job)
    throw Failure(fmt::format("{}: no job is described there", (folder.path() / "job.json").string()));
  folder.clear();
  std::error_code error;
  fs::create_directories(folder.result(), error);
  if (error) throw Failure(fmt::format("{}: cannot be made: {}", folder.result().string(), error.message()));
  Outcome outcome;
  outcome.version = program_version();
  outcome.machine = machine_name();
  outcome.order_sha256 = digest_of(*job);
  try {
    outcome.inputs = note_inputs(*job);
  } catch (const Failure& failure) {
    outcome.reason = as_one_line(failure.what());
    folder.write_outcome(outcome);
    return outcome;
  }
  const ChildEnd end = run_child(command_of(*job, folder, program, threads), folder.log(), stop);
  if (end.stopped) {
    folder.clear();
    return std::nullopt;
  }
  outcome.done = succeeded(*job, folder, end);
  if (!outcome.done) outcome.reason = why(folder, end);
  outcome.seconds = end.seconds;
  outcome.core_seconds = end.core_seconds;
  outcome.peak_memory_bytes = end.peak_memory_bytes;
  folder.write_outcome(outcome);
  return outcome;
}

}  // namespace softarm::app::batch
