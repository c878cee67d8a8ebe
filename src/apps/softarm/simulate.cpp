// softarm simulate: a trial of the virtual rig as a bag, the truth beside it.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "softarm/command.h"
#include "softarm/output_file.h"
#include "softarm/progress.h"
#include "softarm/rig/scenario.h"
#include "softarm/rig/simulator.h"
#include "softarm/rig/truth_csv.h"
#include "softarm/ros/bag_writer.h"
#include "softarm/shipped.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

// Simulated time 0 as a stamp: a constant, so that the same scenario gives the same bag.
constexpr double kEpochS = 1600000000.0;

struct Options {
  std::string scenario;
  std::string out;
  std::string truth;
  std::optional<double> seconds;
  std::optional<std::uint64_t> seed;
};

constexpr const char* kExamples = R"(Examples:
  softarm simulate demo --seconds 30 --out trial.bag
  softarm simulate my_scenario.yaml --seed 7 --out trial.bag --truth /elsewhere/trial.csv
The bag holds what the sensors saw and nothing else; the truth goes to its own file.)";

void record(const rig::Sample& sample, const std::vector<std::string>& bodies, TrialBagWriter& bag) {
  if (sample.payload) bag.payload(sample.payload->stamp_s + kEpochS, sample.payload->kg);
  for (const rig::InputSample& input : sample.inputs) {
    const std::string topic = rig::topic_of(input.kind, input.number);
    const double stamp_s = input.stamp_s + kEpochS;
    if (input.kind == rig::InputKind::kChamber || input.kind == rig::InputKind::kVacuum) {
      bag.pressure(topic, stamp_s, input.value);
    } else {
      bag.scalar(topic, stamp_s, input.value);
    }
  }
  for (std::size_t i = 0; i < sample.bodies.size(); ++i) {
    const std::optional<rig::Pose>& pose = sample.bodies[i];
    if (pose) bag.pose(bodies[i], sample.stamp_s + kEpochS, pose->p, pose->q);
  }
}

void run(const Options& options) {
  const fs::path path = find_config("scenarios", options.scenario);
  rig::Scenario scenario = rig::parse_scenario(read_text(path), path.string());
  if (options.seconds) scenario.duration_s = *options.seconds;
  if (options.seed) scenario.seed = *options.seed;
  if (!(scenario.duration_s > 0.0)) {
    throw Failure(
        fmt::format("{}: the scenario is endless; --seconds says how much of it to record", path.string()));
  }
  OutputFile bag_file(options.out);
  OutputFile truth_file(options.truth.empty() ? fs::path(options.out).replace_extension(".truth.csv")
                                              : fs::path(options.truth));
  if (bag_file.path() == truth_file.path()) throw Failure("--truth must be another file than --out");

  const auto start = std::chrono::steady_clock::now();
  rig::Simulator simulator(scenario);
  TrialBagWriter bag(bag_file.temporary().string());
  std::ofstream truth(truth_file.temporary());
  rig::write_truth_header(truth, scenario);
  Progress progress("frames");
  progress.add_total(static_cast<double>(simulator.frame_count().value_or(0)));
  std::uint64_t frames = 0;
  double last_stamp_s = 0.0;
  while (const std::optional<rig::Sample> sample = simulator.next()) {
    record(*sample, simulator.body_names(), bag);
    rig::write_truth_row(truth, sample->truth, kEpochS);
    progress.advance(1.0, 1);
    ++frames;
    last_stamp_s = sample->stamp_s;
  }
  bag.close();
  truth.close();
  if (!truth) throw Failure(fmt::format("{}: cannot be written", truth_file.path().string()));
  const std::string digest = sha256_of_file(truth_file.temporary());
  truth_file.commit();
  bag_file.commit();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  fmt::print("{}: {} frames, {} messages, {:.3f} s, seed {}\n", bag_file.path().string(), frames,
             bag.messages(), last_stamp_s, scenario.seed);
  fmt::print("bodies lost: {}\n", simulator.dropouts());
  fmt::print("truth: {}\n", truth_file.path().string());
  fmt::print("truth_sha256: {}\n", digest);
  fmt::print("speed: {:.1f} x real time\n", last_stamp_s / wall.count());
}

}  // namespace

void add_simulate(CLI::App& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("simulate", "Record a trial of the virtual rig as a bag.");
  command->add_option("SCENARIO", options->scenario, "scenario file, or the name of one in config/scenarios")
      ->required();
  command->add_option("--out", options->out, "the bag to write")->required();
  command->add_option("--truth", options->truth, "the truth, CSV (default: the bag's name with .truth.csv)");
  command
      ->add_option("--seconds", options->seconds, "record so much simulated time instead of the scenario's")
      ->check(CLI::Range(0.01, 1e6));
  command->add_option("--seed", options->seed, "seed of all random numbers instead of the scenario's");
  command->footer(kExamples);
  command->callback([options] { run(*options); });
}

}  // namespace softarm::app
