// softarm diagnose: trials to what the arm's description leaves out.
#include "softarm/diagnose/diagnose.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <utility>

#include "arm/arm_writer.h"
#include "command.h"
#include "diagnose/arm_file_header.h"
#include "effects/catalogue.h"
#include "model/effect.h"
#include "output_file.h"
#include "progress.h"
#include "read_trials.h"
#include "report/find_page.h"
#include "say.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/identify/identify.h"
#include "softarm/report/report.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct DiagnoseOptions {
  std::string arm, out;
  std::vector<std::string> bags;
  diagnose::Options diagnosis;
  std::optional<double> payload_kg;
  bool effects = false, force = false;
};

// How many effects it will find is not known before: on ten untidy cases the time left was within this factor
// for two thirds of the time.
constexpr double kWithin = 2.0;

constexpr const char* kDiagnoseExamples = R"(Examples:
  softarm diagnose --arm my_arm.yaml trials/*.bag --out report
  softarm diagnose --arm my_arm.yaml --hold '*.bending_stiffness.*' trials/*.bag --out report
What is written:
  report/report.html   what was found, with pictures; one page that needs nothing else
  report/report.json   the same for programs
  report/arm_extended.yaml   the arm file with what was found in it: for estimate, identify, simulate, diagnose and the node
Most informative trials: several speeds, several attitudes of the base, with and without payload.)";

void list_effects() {
  for (const auto& effect : effects::catalogue()) {
    const model::Info& info = effect->info();
    say("{}\n  {}\n", info.id, info.description);
    say("  law: {}{}\n", info.law, info.source.empty() ? "" : " (" + info.source + ")");
    for (std::size_t k = 0; k < info.parameters.size(); ++k) {
      const model::Parameter& p = info.parameters[k];
      say("  {:<26} {:<10} [{:g}, {:g}], usually {:g}{}: {}\n", p.symbol, p.unit, p.low, p.high, p.usual,
          k < static_cast<std::size_t>(info.sizes) ? " (0: absent)"
          : p.held                                 ? " (not fitted)"
                                                   : "",
          p.description);
    }
    say("  easily mistaken for {}\n", fmt::join(info.rivals, ", "));
    if (!info.absorbed_by.empty()) say("  absorbed by the constants {}\n", fmt::join(info.absorbed_by, ", "));
    model::Values usual(static_cast<Eigen::Index>(info.parameters.size()));
    for (std::size_t k = 0; k < info.parameters.size(); ++k)
      usual[static_cast<Eigen::Index>(k)] = info.parameters[k].usual;
    if (const std::string why_not = effect->live_obstacle(usual); !why_not.empty())
      say("  not live: {}\n", why_not);
    say("\n");
  }
}

/// As one word of a shell.
std::string shell_word(const std::string& text) {
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::strchr("_-./+,=:@%", c) != nullptr;
  });
  if (plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The first trial again, with what was found in the model.
std::string next_command(const fs::path& extended, const std::vector<std::string>& bags) {
  return fmt::format("softarm estimate --arm {} {}", shell_word(extended.string()), shell_word(bags.front()));
}

std::string now_utc() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32] = "";
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%MZ", &utc);
  return text;
}

/// Of this run: what was typed, when, and what was read.
report::Origin origin_of(const std::string& arm_file, const std::vector<std::string>& bags) {
  report::Origin origin{"softarm", now_utc(), {}};
  std::ifstream words("/proc/self/cmdline", std::ios::binary);
  std::string word;
  std::getline(words, word, '\0');
  while (std::getline(words, word, '\0')) origin.command += " " + shell_word(word);
  origin.sha256.emplace_back(arm_file, sha256_of_file(arm_file));
  for (const std::string& bag : bags) origin.sha256.emplace_back(bag, sha256_of_file(bag));
  return origin;
}

void run_diagnose(DiagnoseOptions options) {
  if (options.effects) return list_effects();
  if (options.arm.empty()) throw Failure("--arm is needed: the arm file");
  if (options.out.empty()) throw Failure("--out is needed: the folder for the report");
  if (options.bags.empty()) throw Failure("no bag: name the trials' bags");
  arm::Arm arm = arm::load_arm_file(options.arm, config_folders("arms"));
  const arm::ArmText file = arm::read_arm_text(options.arm, config_folders("arms"));
  options.diagnosis.known = effects::effects_of(arm, arm::parse_effect_entries(file.text, file.source));
  if (options.payload_kg) assume_payload(arm, *options.payload_kg);
  const report::FoundPage page = report::find_page(config_folders("report"));
  const ResultsFolder folder(options.out);
  const Replacing replacing = Replacing::of_this_run(options.force);
  OutputFile json(fs::path(options.out) / "report.json", replacing);
  OutputFile html(fs::path(options.out) / "report.html", replacing);
  OutputFile extended(fs::path(options.out) / "arm_extended.yaml", replacing);

  const std::vector<trial::Trial> trials =
      read_trials(options.bags, arm, !options.payload_kg, options.diagnosis.jobs);
  const report::Origin origin = origin_of(file.source, options.bags);
  diagnose::Diagnosis diagnosis;
  {
    Progress progress("", kWithin);
    progress.add_total(1.0);
    double done = 0.0;
    diagnosis =
        diagnose::diagnose(arm, trials, options.diagnosis, [&](double share, const std::string& what) {
          progress.doing(what);
          progress.advance(std::max(0.0, share - done), 1);
          done = std::max(done, share);
        });
  }
  diagnosis.version = SOFTARM_VERSION;
  std::string no_extended;
  try {
    diagnosis.extended_text = arm::update_arm_text(
        file.text, file.source, diagnosis.extended_arm.arm, diagnosis.extended_arm.effects,
        diagnose::arm_file_header(diagnosis, trials), "diagnose", diagnose::to_string(diagnosis.verdict));
    diagnosis.next_command = next_command(extended.path(), options.bags);
  } catch (const arm::ArmError& why) {  // an arm file that cannot be edited is no reason to have no report
    no_extended = why.what();
  }
  if (!page.warning.empty()) fmt::print(stderr, "softarm: warning: {}\n", page.warning);
  // First: it took minutes, and a full disk must not take it away.
  say_text(report::describe(diagnosis));
  std::fflush(stdout);
  json.write(report::to_json(diagnosis, origin));
  html.write(report::to_html(diagnosis, page.files, origin));
  json.commit();
  html.commit();
  std::string written = fmt::format("{}, {}", html.path().string(), json.path().string());
  if (no_extended.empty()) {
    extended.write(diagnosis.extended_text);
    extended.commit();
    written += ", " + extended.path().string();
  } else {
    fmt::print(stderr, "softarm: warning: no {}: {}\n", extended.path().string(), no_extended);
  }
  say("written: {}\n", written);
}

}  // namespace

void add_diagnose(CLI::App& program) {
  const auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command = program.add_subcommand(
      "diagnose", "Find what an arm's description leaves out, where, and how large it is, from trials.");
  command->add_option("--arm", options->arm, "arm file, or the name of one in config/arms");
  command->add_option("BAG", options->bags, "trial bags, each one trial; three or more");
  command->add_option("--out", options->out, "folder for the report");
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_flag("--effects", options->effects, "list the catalogue: what is looked for");
  command
      ->add_option("--block", options->diagnosis.block_s,
                   "time over which frames are averaged, half of it where a body's path bends, up to three "
                   "times where the arm rests, s")
      ->check(CLI::Range(0.02, 2.0))
      ->capture_default_str();
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* meaning) {
    // One value, or several with commas, so that a bag may follow.
    command->add_option(name, values, meaning)->delimiter(',')->allow_extra_args(false);
  };
  list("--hold", options->diagnosis.held, "constants that keep the arm file's value, as in softarm identify");
  list("--tie", options->diagnosis.tied,
       "constants that have one value in all segments: '*.bending_stiffness.base' of segments of one make");
  command
      ->add_option("--most-effects", options->diagnosis.most_effects,
                   "most effects in one verdict; more than 4 only where much is left, or another is certain")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command
      ->add_option("--payload", options->payload_kg,
                   "the known payload, kg; the bags' payload topic is not read")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--jobs", options->diagnosis.jobs, "threads (default: one per core)")
      ->check(CLI::Range(1u, 256u));
  command->footer(kDiagnoseExamples);
  command->callback([options] { run_diagnose(*options); });
}

}  // namespace softarm::app
