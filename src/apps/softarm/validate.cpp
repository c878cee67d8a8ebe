// softarm validate: the papers' published figures, ours beside theirs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "command.h"
#include "output_file.h"
#include "progress.h"
#include "say.h"
#include "softarm/validate/papers.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct Paper {
  const char* name;
  validate::Result (*run)(const validate::Settings&, Progress&);
  double seconds;
};
constexpr std::array<Paper, 5> kPapers{
    {{"semi_physical", validate::semi_physical, validate::kSemiPhysical_s},
     {"online", validate::online, validate::kOnline_s},
     {"single_chamber", validate::single_chamber, validate::kSingleChamber_s},
     {"hybrid", validate::hybrid, validate::kHybrid_s},
     {"cable", validate::cable, validate::kCable_s}}};

struct ValidateOptions {
  std::vector<std::string> only;
  bool quick = false, force = false;
  std::string out;
  std::uint64_t seed = 1;
  unsigned jobs = 0;
};

constexpr const char* kValidateExamples = R"(Examples:
  softarm validate
  softarm validate --only online cable --quick
  softarm validate --out validation && scripts/plot_validation.py validation
Papers: semi_physical, online, single_chamber, hybrid, cable. The exit status says whether everything ran, not
whether the figures agree. doc/validation.md explains each table.)";

/// validation.json and, belonging to it, the series of the plots.
class Outputs {
 public:
  /// @throws Failure if the folder cannot be written, or holds the results of another run
  Outputs(const std::string& path, const Replacing& replacing) {
    if (path.empty()) return;
    folder_.emplace(path);
    path_ = path;
    json_ = std::make_unique<OutputFile>(path_ / "validation.json", replacing);
  }
  void add(const validate::Series& series) {
    if (!json_) return;
    series_.push_back(std::make_unique<OutputFile>(path_ / (series.name + ".csv")));
    series_.back()->write(to_csv(series));
  }
  void commit(const std::string& json) {
    if (!json_) return;
    json_->write(json);
    for (const auto& file : series_) file->commit();
    json_->commit();
  }

 private:
  fs::path path_;
  std::optional<ResultsFolder> folder_;
  std::unique_ptr<OutputFile> json_;
  std::vector<std::unique_ptr<OutputFile>> series_;
};

void run_validate(const ValidateOptions& options) {
  validate::Settings settings;
  settings.seed = options.seed;
  settings.quick = options.quick;
  settings.jobs = options.jobs;
  Outputs outputs(options.out, Replacing::of_this_run(options.force));

  std::vector<Paper> chosen;
  Progress progress("");
  for (const Paper& paper : kPapers) {
    if (!options.only.empty() &&
        std::find(options.only.begin(), options.only.end(), paper.name) == options.only.end())
      continue;
    progress.add_total(paper.seconds);
    chosen.push_back(paper);
  }
  nlohmann::json papers = nlohmann::json::array();
  for (const Paper& paper : chosen) {
    const auto start = std::chrono::steady_clock::now();
    const validate::Result result = paper.run(settings, progress);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    progress.line(fmt::format("{}: {:.1f} s", paper.name, wall.count()));
    say("{}\n", validate::to_text(result));
    std::fflush(stdout);
    papers.push_back(validate::to_json(result));
    for (const validate::Series& series : result.series) outputs.add(series);
  }
  outputs.commit(
      nlohmann::json{{"format", 1}, {"seed", settings.seed}, {"quick", settings.quick}, {"papers", papers}}
          .dump(1) +
      "\n");
}

}  // namespace

void add_validate(CLI::App& program) {
  const auto options = std::make_shared<ValidateOptions>();
  CLI::App* command = program.add_subcommand(
      "validate", "Reproduce the published figures of the papers, ours beside theirs.");
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  command->add_option("--only", options->only, "these papers alone")->check(CLI::IsMember(names));
  command->add_flag("--quick", options->quick, "fewer conditions: a look, not the documented figures");
  command->add_option("--out", options->out, "folder for validation.json and the CSV files of the plots");
  command->add_flag("--force", options->force, kForceMeaning);
  command->add_option("--seed", options->seed, "of conditions and noise")->capture_default_str();
  command->add_option("--jobs", options->jobs, "experiments worked on at a time (default: one per processor)")
      ->check(CLI::Range(1u, 256u));
  command->footer(kValidateExamples);
  command->callback([options] { run_validate(*options); });
}

}  // namespace softarm::app
