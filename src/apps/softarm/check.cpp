// softarm check: what is wrong with a recording, before anyone trusts it.
#include "softarm/check/check.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include "command.h"
#include "math/parallel.h"
#include "output_file.h"
#include "progress.h"
#include "ros/bag_recording.h"
#include "ros/open_bag.h"
#include "say.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr int kFound = 1, kBadUsage = 2;

struct CheckOptions {
  std::string arm;
  std::vector<std::string> bags;
  std::string json;
  bool quiet = false, force = false;
  unsigned jobs = 0;
};

constexpr const char* kCheckExamples = R"(Examples:
  softarm check --arm online_200mm trial.bag
  softarm check --arm my_arm.yaml trials/*.bag --quiet --json findings.json
Exit status: 0 nothing serious, 1 something that spoils estimates, 2 bad usage. doc/check.md lists all findings.)";

check::CheckReport check_bag(const std::string& bag, const arm::Arm& arm, Progress& progress) {
  try {
    const trial::CheckRecording recording = read_recording(
        bag, arm, [&](std::uint64_t total) { progress.add_total(static_cast<double>(total)); },
        [&](std::uint64_t messages) { progress.advance(static_cast<double>(messages), messages); });
    return check::check_recording(recording, arm);
  } catch (const BagError& e) {
    return check::unreadable(bag, e.what());
  }
}

std::vector<check::CheckReport> check_all(const CheckOptions& options, const arm::Arm& arm) {
  std::vector<check::CheckReport> reports(options.bags.size());
  Progress progress("messages");
  math::in_parallel(options.bags.size(), options.jobs,
                    [&](std::size_t i) { reports[i] = check_bag(options.bags[i], arm, progress); });
  return reports;
}

arm::Arm load(const CheckOptions& options) {
  for (const std::string& bag : options.bags) {
    std::error_code error;
    if (!fs::is_regular_file(bag, error)) throw Failure(fmt::format("{}: no such bag", bag), kBadUsage);
  }
  try {
    return arm::load_arm_file(options.arm, config_folders("arms"));
  } catch (const std::exception& e) {
    throw Failure(e.what(), kBadUsage);
  }
}

void run_check(const CheckOptions& options) {
  const arm::Arm arm = load(options);
  std::unique_ptr<OutputFile> json;
  if (!options.json.empty()) {
    try {
      json = std::make_unique<OutputFile>(options.json, Replacing::of_this_run(options.force));
    } catch (const Failure& e) {  // 1 would say that something serious was found
      throw Failure(e.what(), kBadUsage);
    }
  }
  std::vector<check::CheckReport> reports;
  try {
    reports = check_all(options, arm);
  } catch (const std::invalid_argument& e) {  // the arm file names a type that no adapter reads
    throw Failure(e.what(), kBadUsage);
  }
  const std::vector<check::CheckFinding> together = check::check_together(reports);
  say_text(to_text(reports, together, !options.quiet));
  if (json) {
    json->write(to_json(reports, arm.name, together));
    json->commit();
  }
  const bool serious = std::any_of(reports.begin(), reports.end(), [](const check::CheckReport& report) {
    return report.worst() == check::Severity::kSerious;
  });
  if (serious) throw Ended(kFound);
}

}  // namespace

void add_check(CLI::App& program) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = program.add_subcommand("check", "Say what is wrong with recordings, and the remedy.");
  command->add_option("--arm", options->arm, "arm file, or the name of one in config/arms")->required();
  command->add_option("BAG", options->bags, "trial bags")->required();
  command->add_option("--json", options->json, "also write the findings to this file");
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_flag("--quiet", options->quiet, "leave out what is mere information");
  command->add_option("--jobs", options->jobs, "bags worked on at a time (default: one per processor)")
      ->check(CLI::Range(1u, 256u));
  command->footer(kCheckExamples);
  command->callback([options] { run_check(*options); });
}

}  // namespace softarm::app
