// Identification of an arm's constants from trials in memory.
#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "frames.h"
#include "softarm/identify/identify.h"

namespace softarm::bench {
namespace {

/// The semi-physical paper's arm with elongations a tenth of the printed ones, which
/// would double its length.
arm::Arm pneumatic_arm() {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/semi_physical_200mm.yaml");
  std::stringstream text;
  text << file.rdbuf();
  arm::Arm arm = arm::parse_arm(text.str(), "semi_physical_200mm.yaml");
  for (arm::Chamber& chamber : arm.segments[0].chambers) {
    chamber.near_elongation_m_per_pa *= 0.1;
    chamber.far_elongation_m_per_pa *= 0.1;
  }
  return arm;
}

/// 30 trials of the paper's protocol: 2 s at rest without load and 2 s under 200 g, at 120 Hz.
std::vector<trial::Trial> paper_trials(const arm::Arm& arm) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.0005);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<double> stations;
  for (const arm::MeasuredBody& body : arm.bodies) stations.push_back(body.arclength_m);
  rod::Rod rod = rod::make_rod(arm);
  rod.q_base = hanging();
  rod::Solver solver(rod, stations, {});
  std::vector<trial::Trial> trials;
  while (trials.size() < 30) {
    arm::InputValues inputs;
    for (int i = 0; i < 3; ++i) inputs.emplace_back(uniform(0.0, 1.0) < 0.3 ? 0.0 : uniform(10e3, 50e3));
    inputs.emplace_back(uniform(0.0, 1.0) < 0.5 ? 0.0 : 60e3);
    const auto laws = predict(arm, inputs);
    rod::actuate(arm, *laws, rod);
    trial::Trial trial;
    trial.name = "trial_" + std::to_string(trials.size() + 1);
    for (const double payload_kg : {0.0, 0.2}) {
      rod.loads[rod::kPayloadLoad].mass_kg = payload_kg;
      if (solver.solve(rod) != rod::SolveStatus::kConverged) break;
      for (int i = 0; i < 240; ++i) {
        trial::Frame frame;
        frame.stamp_ns = trial::to_nanoseconds((payload_kg > 0.0 ? 2.0 : 0.0) + i / 120.0);
        frame.inputs = inputs;
        frame.payload_kg = payload_kg;
        frame.base_body = Eigen::Isometry3d(hanging());
        for (int k = 0; k < solver.stations(); ++k) {
          const Eigen::Vector3d error(noise(random), noise(random), noise(random));
          frame.bodies.push_back({k, solver.station(k).p + error, std::nullopt});
        }
        trial.frames.push_back(frame);
      }
    }
    if (trial.frames.size() == 480) trials.push_back(std::move(trial));
  }
  return trials;
}

/// Twelve constants: gains, elongations, b1 to b3, length and rest curvature; a third of the trials unseen,
/// errors before and after, uncertainties and prior included.
void identify_30_trials(benchmark::State& state) {
  const arm::Arm truth = pneumatic_arm();
  const std::vector<trial::Trial> trials = paper_trials(truth);
  arm::Arm start = truth;
  double share = 0.2;
  for (const identify::ConstantRef& constant : identify::default_free(truth)) {
    identify::set_value(start, constant, identify::value_of(truth, constant) * (1.0 + share));
    share = -share;
  }
  identify::Options options;
  options.also_free = {"length", "*.rest_curvature.*"};
  std::size_t constants = 0, frames = 0;
  for (auto _ : state) {
    const identify::Result result = identify::identify(start, trials, options);
    if (!result.converged) state.SkipWithError("not converged");
    constants = result.constants.size();
    frames = result.frames;
  }
  state.counters["constants"] = static_cast<double>(constants);
  state.counters["frames"] = static_cast<double>(frames);
}
BENCHMARK(identify_30_trials)->Unit(benchmark::kMillisecond)->MinTime(2.0);

}  // namespace
}  // namespace softarm::bench
