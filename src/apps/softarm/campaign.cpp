// softarm campaign: many random trials of the virtual rig, the truth of all of them sealed.
#include "rig/campaign.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "command.h"
#include "math/parallel.h"
#include "output_file.h"
#include "output_lock.h"
#include "progress.h"
#include "record_trial.h"
#include "rig/simulator.h"
#include "say.h"
#include "shipped.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr int kAttempts = 20;

struct CampaignOptions {
  std::string campaign;
  std::string out;
  int cases = 10;
  std::uint64_t seed = 1;
  unsigned jobs = 0;
};

constexpr const char* kCampaignExamples = R"(Examples:
  softarm campaign development --cases 20 --seed 1 --out campaign
What is written:
  campaign/campaign.json              cases, their arm files and trials: all that a laboratory would know
  campaign/case_001/trial_01.bag ...  the trials
  campaign/truth/                     what was hidden: cases.json for all, and of each trial the time series and the
                                      constants; SHA256SUMS seals it, and its own digest is printed)";

/// A folder that appears whole or not at all.
class OutputFolder {
 public:
  explicit OutputFolder(const fs::path& path) : path_(path), temporary_(path.string() + ".partial") {
    std::error_code error;
    if (fs::exists(path_) && !(fs::is_directory(path_) && fs::is_empty(path_, error)))
      throw Failure(fmt::format("--out {}: exists already, expected a new or empty folder", path_.string()));
    fs::create_directories(temporary_, error);
    if (error) throw Failure(fmt::format("--out {}: {}", path_.string(), error.message()));
    lock_.emplace(temporary_,
                  fmt::format("--out {}: another campaign is being written there", path_.string()));
    for (const fs::directory_entry& left : fs::directory_iterator(temporary_, error))
      fs::remove_all(left.path(), error);
  }
  ~OutputFolder() {
    std::error_code ignored;
    if (!committed_) fs::remove_all(temporary_, ignored);
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  const fs::path& temporary() const { return temporary_; }
  void commit() {
    std::error_code error;
    fs::remove(path_, error);
    fs::rename(temporary_, path_, error);
    if (error) throw Failure(fmt::format("--out {}: {}", path_.string(), error.message()));
    committed_ = true;
  }

 private:
  fs::path path_, temporary_;
  std::optional<OutputLock> lock_;
  bool committed_ = false;
};

struct RecordedCase {
  rig::CampaignCase drawn;
  std::vector<std::string> trials;
  std::vector<std::pair<std::string, std::string>> digests;  ///< SHA-256, path below truth/
  double seconds = 0.0;
};

std::string case_name(std::size_t number) {
  return fmt::format("case_{:03}", number + 1);
}

/// Records one case; draws it again where an effect drives the arm where nothing holds it.
RecordedCase record_case(const rig::CampaignSpec& spec, const std::vector<rig::Scenario>& arms,
                         const CampaignOptions& options, std::size_t number, const fs::path& folder,
                         Progress& progress) {
  const std::string name = case_name(number);
  for (int attempt = 0;; ++attempt) {
    RecordedCase recorded;
    recorded.drawn = rig::draw_case(spec, arms, options.seed, static_cast<int>(number), attempt);
    fs::create_directories(folder / name);
    fs::create_directories(folder / "truth" / name);
    try {
      for (std::size_t i = 0; i < recorded.drawn.trials.size(); ++i) {
        const std::string trial = fmt::format("trial_{:02}", i + 1);
        const RecordedTrial done = record_trial(recorded.drawn.trials[i], folder / name / (trial + ".bag"),
                                                folder / "truth" / name / (trial + ".truth.csv"), [] {});
        recorded.trials.push_back(name + "/" + trial + ".bag");
        recorded.seconds += done.duration_s;
        recorded.digests.emplace_back(done.series_sha256, name + "/" + done.truth_series.filename().string());
        recorded.digests.emplace_back(done.description_sha256,
                                      name + "/" + done.truth_description.filename().string());
        progress.advance(1.0, 1);
      }
      return recorded;
    } catch (const rig::SimulationError& error) {
      progress.advance(-static_cast<double>(recorded.trials.size()), 0);
      fs::remove_all(folder / name);
      fs::remove_all(folder / "truth" / name);
      if (attempt + 1 >= kAttempts)
        throw Failure(
            fmt::format("{}: {} draws could not be simulated, the last: {}", name, kAttempts, error.what()));
    }
  }
}

nlohmann::ordered_json to_json(const std::vector<rig::HiddenChoice>& choices) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const rig::HiddenChoice& choice : choices) {
    const rig::HiddenEffect& effect = *rig::find_hidden_effect(choice.effect);
    nlohmann::ordered_json item{{"effect", choice.effect}, {"catalogued", effect.catalogued}};
    if (!effect.like.empty()) item["like"] = effect.like;
    if (!choice.form.empty()) item["form"] = choice.form;
    for (const auto& [key, value] : choice.values) item["values"][key] = value;
    list.push_back(item);
  }
  return list;
}

void run_campaign(const CampaignOptions& options) {
  const fs::path path = find_config("campaigns", options.campaign);
  const rig::CampaignSpec spec = rig::parse_campaign(read_text(path), path.string());
  std::vector<rig::Scenario> arms;
  for (const rig::CampaignArm& arm : spec.arms) {
    const fs::path scenario = find_config("scenarios", arm.scenario);
    arms.push_back(rig::parse_scenario(read_text(scenario), scenario.string()));
    find_config("arms", arm.arm);
  }
  OutputFolder out(options.out);
  const auto count = static_cast<std::size_t>(options.cases);
  std::vector<RecordedCase> cases(count);
  Progress progress("trials");
  progress.add_total(static_cast<double>(count) * spec.trials);
  try {
    math::in_parallel(count, options.jobs, [&](std::size_t i) {
      cases[i] = record_case(spec, arms, options, i, out.temporary(), progress);
    });
  } catch (const std::invalid_argument& error) {
    throw Failure(fmt::format("{}: {}", path.string(), error.what()));
  }

  nlohmann::ordered_json known{{"format", 1}},
      sealed{{"format", 1}, {"campaign", spec.name}, {"seed", options.seed}};
  std::string sums;
  double seconds = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const RecordedCase& one = cases[i];
    known["cases"].push_back(
        {{"name", case_name(i)}, {"arm", spec.arms[one.drawn.arm].arm}, {"trials", one.trials}});
    sealed["cases"].push_back({{"name", case_name(i)},
                               {"effects", to_json(one.drawn.effects)},
                               {"distractors", to_json(one.drawn.distractors)}});
    for (const auto& [digest, file] : one.digests) sums += fmt::format("{}  {}\n", digest, file);
    seconds += one.seconds;
  }
  const fs::path truth = out.temporary() / "truth";
  write_text(out.temporary() / "campaign.json", known.dump(1) + "\n");
  write_text(truth / "cases.json", sealed.dump(1) + "\n");
  sums += fmt::format("{}  cases.json\n", sha256_of_file(truth / "cases.json"));
  write_text(truth / "SHA256SUMS", sums);
  const std::string digest = sha256_of_file(truth / "SHA256SUMS");
  out.commit();
  say("{}: {} cases, {} trials, {:.0f} s of recordings\n", options.out, count,
      count * static_cast<std::size_t>(spec.trials), seconds);
  say("truth: {}\n", (fs::path(options.out) / "truth").string());
  say("truth_sha256: {} (of truth/SHA256SUMS)\n", digest);
}

}  // namespace

void add_campaign(CLI::App& program) {
  const auto options = std::make_shared<CampaignOptions>();
  CLI::App* command = program.add_subcommand(
      "campaign", "Draw many random trials with something hidden in them, and record them.");
  command->add_option("CAMPAIGN", options->campaign, "campaign file, or the name of one in config/campaigns")
      ->required();
  command->add_option("--out", options->out, "the folder to write")->required();
  command->add_option("--cases", options->cases, "how many (default 10)")->check(CLI::Range(1, 100000));
  command->add_option("--seed", options->seed, "seed of all draws (default 1)");
  command
      ->add_option("--jobs", options->jobs, "how many cases at a time (default: as many as there are cores)")
      ->check(CLI::Range(1, 1024));
  command->footer(kCampaignExamples);
  command->callback([options] { run_campaign(*options); });
}

}  // namespace softarm::app
