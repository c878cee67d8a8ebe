// The rig's own numerical error over whole trials: what the default steps and elements are good for.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "rig/simulator.h"

namespace softarm::rig {
namespace {

constexpr double kTrialSeconds = 6.0, kNumericalErrorM = 5e-6;

/// The demo for some seconds, with a payload that a hand changes within them.
Scenario demo_trial(const std::string& hidden) {
  const std::string file = std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/demo.yaml";
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf() << "\nhidden: [{effect: " << hidden << "}]\n";
  Scenario scenario = parse_scenario(text.str(), file);
  scenario.duration_s = kTrialSeconds;
  scenario.payload.repeat_s = 0.0;
  scenario.payload.schedule = {{0.0, {0.15}}, {4.0, {0.24}}};
  return scenario;
}

/// Where the rings really are, frame by frame.
std::vector<Eigen::Vector3d> ring_path(Scenario scenario, const NumericsSpec& numerics) {
  scenario.numerics = numerics;
  Simulator simulator(scenario);
  std::vector<Eigen::Vector3d> result;
  while (const auto sample = simulator.next())
    for (const Pose& ring : sample->truth.rings_base) result.push_back(ring.p);
  return result;
}

double farthest(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double worst = a.size() == b.size() ? 0.0 : 1.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

void expect_converged(const std::string& hidden) {
  const Scenario scenario = demo_trial(hidden);
  const NumericsSpec usual;
  const auto fine = ring_path(scenario, {2 * usual.elements, usual.max_step_s / 2.0});
  EXPECT_LT(farthest(ring_path(scenario, usual), fine), kNumericalErrorM);
  // The trial is lively enough to tell: too long a step shows.
  EXPECT_GT(farthest(ring_path(scenario, {usual.elements, 4.0 * usual.max_step_s}), fine), kNumericalErrorM);
}

TEST(RigConvergence, ATrialWithLagHardlyChangesWithFinerNumerics) {
  expect_converged("pressure_lag, time_constant_s: 0.1");
}

TEST(RigConvergence, ATrialWithHysteresisHardlyChangesWithFinerNumerics) {
  expect_converged("hysteresis, form: material, loop_per_m: 0.5");
}

}  // namespace
}  // namespace softarm::rig
