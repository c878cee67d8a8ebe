// Whole frames through the estimator: base, fit, outliers, covariance, identifiability; without sampling
// the backbone for display, which has a benchmark of its own.
#include <benchmark/benchmark.h>

#include <chrono>
#include <stdexcept>

#include "frames.h"
#include "model/online_effects.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"

namespace softarm::bench {
namespace {

void estimate_all(benchmark::State& state, const arm::Arm& arm, const std::vector<trial::Frame>& frames,
                  bool warm, int backbone_points = 0, const std::vector<model::Present>& effects = {},
                  arm::Dynamics dynamics = arm::Dynamics::kStatic) {
  arm::EstimatorOptions options = arm.estimator;
  options.dynamics = dynamics;
  options.method = arm::Method::kFullPoints;
  options.unknown = arm::Unknown::kStiffness;
  options.objective = arm::Objective::kLeastSquares;
  estimate::Estimator estimator(arm, options, effects);
  estimator.set_backbone_points(backbone_points);
  estimator.estimate(frames.front());
  Times times;
  double iterations = 0.0, solves = 0.0, refused = 0.0;
  std::size_t i = 0;
  for (auto _ : state) {
    if (!warm || i == 0) estimator.reset();
    const auto start = std::chrono::steady_clock::now();
    const estimate::Estimate& estimate = estimator.estimate(frames[i]);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    state.SetIterationTime(seconds);
    if (!warm || i > 0) times.add(seconds);
    iterations += estimate.solver.iterations;
    solves += estimate.solver.rod_solves;
    refused += estimate.status == estimate::Status::kOk ? 0.0 : 1.0;
    i = (i + 1) % frames.size();
  }
  if (refused > 0.0) {
    state.SkipWithError("frames were refused");
    return;
  }
  const double count = static_cast<double>(state.iterations());
  state.counters["median_us"] = times.quantile_us(0.5);
  state.counters["p99_us"] = times.quantile_us(0.99);
  state.counters["iterations"] = iterations / count;
  state.counters["rod_solves"] = solves / count;
}

std::vector<trial::Frame> moving_frames(const arm::Arm& arm, const Eigen::Quaterniond& q_base) {
  return make_frames(arm, 2000, q_base, [](int i, std::mt19937_64&) { return moving_truth(i); });
}

/// The base tilted by 40 degrees: the load bends the arm out of the plane of its actuation.
Eigen::Quaterniond tilted() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.8, 0.6, 0.0))) * hanging();
}

/// The baselines' frames, each from nothing.
void frame_fit_cold(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, random_frames(arm), false);
}
BENCHMARK(frame_fit_cold)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// A motion at 120 Hz, each frame from the last.
void frame_fit_warm(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, hanging()), true);
}
BENCHMARK(frame_fit_warm)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// The same followed through its swings.
void frame_fit_modal(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, hanging()), true, 0, {}, arm::Dynamics::kModal);
}
BENCHMARK(frame_fit_modal)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// The same as frame_fit_warm with the base tilted.
void frame_fit_3d(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, tilted()), true);
}
BENCHMARK(frame_fit_3d)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

void frame_fit_3d_cold(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, tilted()), false);
}
BENCHMARK(frame_fit_3d_cold)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// With the 41 points of the backbone that the node publishes.
void frame_fit_warm_with_backbone(benchmark::State& state) {
  const arm::Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, hanging()), true, 41);
}
BENCHMARK(frame_fit_warm_with_backbone)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// The motion of frame_fit_warm by an arm with effects, as its own model makes it.
std::vector<trial::Frame> extended_frames(const arm::Arm& arm, const std::vector<model::Present>& effects) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.0005);
  model::OnlineEffects model(arm, effects);
  const Eigen::Quaterniond q_base = hanging();
  std::vector<trial::Frame> frames;
  for (int i = 0; i < 2000; ++i) {
    const Truth truth = moving_truth(i);
    trial::Frame frame;
    frame.stamp_ns = trial::to_nanoseconds(1.0 + i / 120.0);
    frame.base_body = Eigen::Isometry3d(q_base);
    frame.payload_kg = truth.payload;
    arm::SegmentPrediction segment;
    segment.moment_nm = truth.moment * Eigen::Vector2d(std::cos(truth.phi), std::sin(truth.phi));
    segment.bending_stiffness_nm2 = truth.stiffness;
    segment.length_m = truth.length;
    model.begin(frame.stamp_s(), {}, truth.payload, *frame.base_body);
    if (!model.solve({segment}, truth.payload)) throw std::runtime_error("a frame without equilibrium");
    model.keep();
    for (int k = 0; k < static_cast<int>(arm.bodies.size()); ++k) {
      const Eigen::Vector3d error(noise(random), noise(random), noise(random));
      frame.bodies.push_back({k, q_base * model.bodies().p.col(k) + error, std::nullopt});
    }
    frames.push_back(frame);
  }
  return frames;
}

void estimate_extended(benchmark::State& state, const std::vector<arm::EffectEntry>& entries) {
  const arm::Arm arm = paper_arm();
  const std::vector<model::Present> effects = effects::effects_of(arm, entries);
  estimate_all(state, arm, extended_frames(arm, effects), true, 0, effects);
}

/// A clamp that yields and something at the tip that nobody weighed, both as well known as a diagnosis knows
/// them: no memory.
void frame_fit_extended(benchmark::State& state) {
  estimate_extended(state, {{"base_compliance", {{"compliance_rad_per_nm", 0.1, 0.01}}},
                            {"tip_mass", {{"mass_kg", 0.02, 0.002}}}});
}
BENCHMARK(frame_fit_extended)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// Ends that do not bend and a taper of the actuation, neither of which asks for the shape.
void frame_fit_extended_profile(benchmark::State& state) {
  estimate_extended(
      state, {{"rigid_ends", {{"base_m", 0.02}, {"tip_m", 0.01}}}, {"actuation_taper", {{"share", 0.15}}}});
}
BENCHMARK(frame_fit_extended_profile)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// A wall that creeps and a clamp that yields.
void frame_fit_extended_memory(benchmark::State& state) {
  estimate_extended(state, {{"creep", {{"share", 0.2, 0.02}, {"time_s", 3.0, 0.3}}},
                            {"base_compliance", {{"compliance_rad_per_nm", 0.1, 0.01}}}});
}
BENCHMARK(frame_fit_extended_memory)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

}  // namespace
}  // namespace softarm::bench
