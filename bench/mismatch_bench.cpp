// The live monitor on a stream of frames and their estimates: the mean per frame. Most are quicker, one in 25
// ms also tests for changes.
#include <benchmark/benchmark.h>

#include <utility>

#include "frames.h"
#include "softarm/estimate/estimator.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::bench {
namespace {

/// @param inputs chamber pressures of frame i, gauge Pa
template <typename InputsOf>
void monitor(benchmark::State& state, double rate_hz, InputsOf inputs_of) {
  const arm::Arm arm = paper_arm();
  std::vector<trial::Frame> frames =
      make_frames(arm, 2400, hanging(), [](int i, std::mt19937_64&) { return moving_truth(i); });
  estimate::Estimator estimator(arm);
  std::vector<estimate::Estimate> estimates;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].stamp_ns = trial::to_nanoseconds(static_cast<double>(i) / rate_hz);
    frames[i].inputs = inputs_of(frames[i]);
    estimates.push_back(estimator.estimate(frames[i]));
  }
  monitor::MismatchMonitor mismatch(arm);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(mismatch.add(frames[i], estimates[i]));
    i = (i + 1) % frames.size();
  }
}

arm::InputValues some_pressures(const trial::Frame& frame) {
  const double a = 3e4 + 2e4 * std::sin(frame.stamp_s());
  return {a, 5e4 - a, 1e4};
}

void mismatch_frame_120hz(benchmark::State& state) {
  monitor(state, 120.0, some_pressures);
}
BENCHMARK(mismatch_frame_120hz)->Unit(benchmark::kMicrosecond)->Iterations(24000);

void mismatch_frame_240hz(benchmark::State& state) {
  monitor(state, 240.0, some_pressures);
}
BENCHMARK(mismatch_frame_240hz)->Unit(benchmark::kMicrosecond)->Iterations(24000);

void mismatch_frame_without_laws(benchmark::State& state) {
  monitor(state, 120.0, [](const trial::Frame&) { return arm::InputValues(); });
}
BENCHMARK(mismatch_frame_without_laws)->Unit(benchmark::kMicrosecond)->Iterations(24000);

}  // namespace
}  // namespace softarm::bench
