// Unlabelled points given to the rings of an arm: the usual frame, and the dearest.
#include <benchmark/benchmark.h>

#include <chrono>

#include "frames.h"
#include "trial/point_association.h"

namespace softarm::bench {
namespace {

constexpr int kRings = 4, kHiddenRing = 2;
constexpr double kLength_m = 0.2, kRate_hz = 120.0;
// Of each so many frames the ring is hidden in the last ones: for 50 ms, nearly as long as it is predicted.
constexpr int kPeriod = 20, kHidden = 6;
constexpr int kGhostsEnter = 12;  // when the rings are known

arm::Arm ringed_arm() {
  arm::Arm arm;
  arm.name = "rings";
  arm.segments.resize(1);
  arm.segments[0].length_m = kLength_m;
  for (int i = 1; i <= kRings; ++i) {
    arm::MeasuredBody body;
    body.name = "ring_" + std::to_string(i);
    body.arclength_m = kLength_m * i / kRings;
    body.position_sd_m = 3e-4;
    arm.bodies.push_back(body);
  }
  return arm;
}

/// Of an arc that sways.
Eigen::Vector3d ring_at(int ring, double t) {
  const double s = kLength_m * (ring + 1) / kRings;
  const double angle = (1.0 + 0.3 * std::sin(2.0 * t)) * s / kLength_m, radius = s / angle;
  return {radius * (1.0 - std::cos(angle)), 0.0, radius * std::sin(angle)};
}

/// Of a lattice of 25 mm those nearest to the ring that is hidden, but none so near to where a ring ever is.
std::vector<Eigen::Vector3d> ghosts_about(std::size_t count) {
  constexpr double kApart_m = 0.025;
  constexpr int kHalf = 6, kSide = 2 * kHalf + 1;
  const Eigen::Vector3d middle = ring_at(kHiddenRing, 0.0);
  std::vector<Eigen::Vector3d> ghosts;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const Eigen::Vector3d ghost =
        middle +
        kApart_m * Eigen::Vector3d(i % kSide - kHalf, i / kSide % kSide - kHalf, i / (kSide * kSide) - kHalf);
    bool is_clear = true;
    for (int k = 0; k < 100 * kRings; ++k)
      is_clear = is_clear && (ring_at(k % kRings, 0.04 * (k / kRings)) - ghost).norm() >= kApart_m;
    if (is_clear) ghosts.push_back(ghost);
  }
  std::stable_sort(ghosts.begin(), ghosts.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - middle).norm() < (b - middle).norm();
  });
  ghosts.resize(std::min(count, ghosts.size()));
  return ghosts;
}

/// The points of a frame, without the ring that is hidden.
std::vector<Eigen::Vector3d> points_of(int frame, bool is_hidden,
                                       const std::vector<Eigen::Vector3d>& ghosts) {
  const double t = frame / kRate_hz;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t g = 0; g < ghosts.size() && frame >= kGhostsEnter; ++g) {
    const double phase = static_cast<double>(g);
    points.push_back(ghosts[g] + 0.002 * Eigen::Vector3d(std::sin(2.0 * t + phase), std::cos(2.0 * t + phase),
                                                         std::sin(1.3 * t + 2.0 * phase)));
  }
  for (int ring = 0; ring < kRings; ++ring) {
    if (ring != kHiddenRing || !is_hidden) points.push_back(ring_at(ring, t));
  }
  return points;
}

/// @param hide a ring, again and again; timed is the last frame before it is there again, as then it may be
/// farthest from where it was and most ghosts contend for its place
void associate(benchmark::State& state, std::size_t ghost_count, bool hide) {
  const arm::Arm arm = ringed_arm();
  const std::vector<Eigen::Vector3d> ghosts = ghosts_about(ghost_count);
  trial::PointAssociator associator(arm);
  Times times;
  int frame = 0;
  for (auto _ : state) {
    double seconds = 0.0;
    do {
      const bool is_hidden = hide && frame % kPeriod >= kPeriod - kHidden;
      const std::vector<Eigen::Vector3d> points = points_of(frame, is_hidden, ghosts);
      const auto start = std::chrono::steady_clock::now();
      const auto found = associator.update(frame / kRate_hz, points);
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      for (int ring = 0; ring < kRings; ++ring) {
        if (found[static_cast<std::size_t>(ring)].has_value() != (ring != kHiddenRing || !is_hidden)) {
          state.SkipWithError("a ring that is there is absent, or a ghost is the hidden one");
          return;
        }
      }
      ++frame;
    } while (hide && frame % kPeriod != 0);
    state.SetIterationTime(seconds);
    times.add(seconds);
  }
  state.counters["median_us"] = times.quantile_us(0.5);
  state.counters["p99_us"] = times.quantile_us(0.99);
}

/// Four rings and four ghosts.
void association_frame(benchmark::State& state) {
  associate(state, 4, false);
}
BENCHMARK(association_frame)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(20000);

/// Sixty ghosts, and one of the rings hidden for 50 ms.
void association_hidden_ring(benchmark::State& state) {
  associate(state, 60, true);
}
BENCHMARK(association_hidden_ring)->UseManualTime()->Unit(benchmark::kMicrosecond)->Iterations(1000);

}  // namespace
}  // namespace softarm::bench
