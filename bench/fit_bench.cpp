// Whole frames through the estimator: base, fit, outliers, covariance, what the frame tells; without sampling
// the backbone for display, which has a benchmark of its own.
#include <benchmark/benchmark.h>

#include <chrono>

#include "frames.h"
#include "softarm/fit/estimator.h"

namespace softarm::bench {
namespace {

void estimate_all(benchmark::State& state, const Arm& arm, const std::vector<Frame>& frames, bool warm,
                  int backbone_points = 0) {
  EstimatorOptions options = arm.estimator;
  options.method = Method::kFullPoints;
  options.unknown = Unknown::kStiffness;
  options.objective = Objective::kLeastSquares;
  Estimator estimator(arm, options);
  estimator.set_backbone_points(backbone_points);
  estimator.estimate(frames.front());
  Times times;
  double iterations = 0.0, solves = 0.0, refused = 0.0;
  std::size_t i = 0;
  for (auto _ : state) {
    if (!warm || i == 0) estimator.reset();
    const auto start = std::chrono::steady_clock::now();
    const Estimate& estimate = estimator.estimate(frames[i]);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    state.SetIterationTime(seconds);
    if (!warm || i > 0) times.add(seconds);
    iterations += estimate.solver.iterations;
    solves += estimate.solver.rod_solves;
    refused += estimate.status == Status::kOk ? 0.0 : 1.0;
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

std::vector<Frame> moving_frames(const Arm& arm, const Eigen::Quaterniond& q_base) {
  return make_frames(arm, 2000, q_base, [](int i, std::mt19937_64&) { return moving_truth(i); });
}

/// The base tilted by 40 degrees: the load bends the arm out of the plane of its actuation.
Eigen::Quaterniond tilted() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.8, 0.6, 0.0))) * hanging();
}

/// The baselines' frames, each from nothing.
void frame_fit_cold(benchmark::State& state) {
  const Arm arm = paper_arm();
  estimate_all(state, arm, random_frames(arm), false);
}
BENCHMARK(frame_fit_cold)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// A motion at 120 Hz, each frame from the last.
void frame_fit_warm(benchmark::State& state) {
  const Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, hanging()), true);
}
BENCHMARK(frame_fit_warm)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// The same with the base tilted.
void frame_fit_3d(benchmark::State& state) {
  const Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, tilted()), true);
}
BENCHMARK(frame_fit_3d)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

void frame_fit_3d_cold(benchmark::State& state) {
  const Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, tilted()), false);
}
BENCHMARK(frame_fit_3d_cold)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

/// With the 41 points of the backbone that the node publishes.
void frame_fit_warm_with_backbone(benchmark::State& state) {
  const Arm arm = paper_arm();
  estimate_all(state, arm, moving_frames(arm, hanging()), true, 41);
}
BENCHMARK(frame_fit_warm_with_backbone)->UseManualTime()->Unit(benchmark::kMicrosecond)->MinTime(1.0);

}  // namespace
}  // namespace softarm::bench
