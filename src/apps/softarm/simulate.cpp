// softarm simulate: a trial of the virtual rig as a bag, the truth beside it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "command.h"
#include "effects_list.h"
#include "output_file.h"
#include "progress.h"
#include "record_trial.h"
#include "rig/scenario.h"
#include "say.h"
#include "scenario_file.h"
#include "shipped.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  std::string scenario;
  std::string out;
  std::string truth;
  std::optional<double> seconds;
  std::optional<std::uint64_t> seed;
  bool force = false;
};

constexpr const char* kSimulateExamples = R"(Examples:
  softarm simulate demo --seconds 30 --out trial.bag
  softarm simulate my_scenario.yaml --seed 7 --out trial.bag --truth /elsewhere/trial.csv
  softarm simulate my_arm.yaml --seconds 30 --out trial.bag                  that arm, moving at random
A scenario whose `arm:` is the name or path of an arm file simulates that arm: its bodies, base, topics and effects.
The bag holds what the sensors saw and nothing else. The truth goes to files of its own: its time series
(.truth.csv), what was hidden (.truth.yaml), and their digests (.truth.sha256; sha256sum -c checks them).)";

void run_simulate(const SimulateOptions& options) {
  const fs::path path = find_config("scenarios", options.scenario);
  auto [scenario, is_arm_file, arm] = load_scenario(options.scenario);
  if (options.seconds) scenario.duration_s = *options.seconds;
  if (options.seed) scenario.seed = *options.seed;
  if (!(scenario.duration_s > 0.0)) {
    throw Failure(fmt::format("{}: {} is endless; --seconds says how much of it to record", path.string(),
                              is_arm_file ? "is an arm file; its arm, moving at random," : "the scenario"));
  }
  const fs::path bag = options.out;
  const fs::path truth =
      options.truth.empty() ? fs::path(options.out).replace_extension(".truth.csv") : fs::path(options.truth);
  if (truth == bag) throw Failure("--truth must be another file than --out");

  const auto start = std::chrono::steady_clock::now();
  Progress progress("frames");
  progress.add_total(std::floor(scenario.duration_s * scenario.mocap.rate_hz) + 1.0);
  const RecordedTrial done = record_trial(
      scenario, bag, truth, [&] { progress.advance(1.0, 1); }, arm, Replacing::of_this_run(options.force));
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  say("{}: {} frames, {} messages, {:.3f} s, seed {}\n", bag.string(), done.frames, done.messages,
      done.duration_s, scenario.seed);
  say("bodies lost: {}\n", done.bodies_lost);
  say("truth: {}, {}\n", done.truth_series.string(), done.truth_description.string());
  say("truth_sha256: {}, {} (kept in {})\n", done.series_sha256, done.description_sha256, done.seal.string());
  say("speed: {:.1f} x real time\n", done.duration_s / wall.count());
}

}  // namespace

void add_simulate(CLI::App& program) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = program.add_subcommand("simulate", "Record a trial of the virtual rig as a bag.");
  command
      ->add_option("SCENARIO", options->scenario,
                   "scenario file, or the name of one in config/scenarios; or an arm file")
      ->required();
  command->add_option("--out", options->out, "the bag to write")->required();
  command->add_option("--truth", options->truth,
                      "the truth's time series, CSV (default: the bag's name with .truth.csv)");
  command
      ->add_option("--seconds", options->seconds, "record so much simulated time instead of the scenario's")
      ->check(CLI::Range(0.01, 1e6));
  command->add_option("--seed", options->seed, "seed of all random numbers instead of the scenario's");
  command->add_flag("--force", options->force, kForceMeaning);
  // Like --help it needs nothing else.
  command
      ->add_flag_callback(
          "--effects",
          [] {
            say_text(effects_list());
            throw CLI::Success();
          },
          "list all that a scenario can hide in the arm, its inputs and its sensors, and exit")
      ->trigger_on_parse();
  command->footer(kSimulateExamples);
  command->callback([options] { run_simulate(*options); });
}

}  // namespace softarm::app
