// The estimator with effects in its model, on frames of the virtual rig that has them: EI of single frames is
// wrong without them, and right with them, within the intervals that are stated.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>
#include <vector>

#include "effects/drive_trials.h"
#include "softarm/effects/arm_effects.h"
#include "softarm/estimate/estimator.h"

namespace softarm::effects::testing {
namespace {

constexpr double kEpoch_s = 100.0;

struct Recorded {
  std::vector<trial::Frame> frames;
  std::vector<rig::Truth> truth;  ///< one per frame
};

Recorded recorded_frames(const arm::Arm& arm, const rig::Scenario& scenario) {
  rig::Simulator simulator(scenario);
  trial::FrameAssembler assembler(arm);
  Recorded recorded;
  while (const auto sample = simulator.next()) {
    recorded.truth.push_back(sample->truth);
    if (sample->payload) assembler.add_payload(kEpoch_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kEpoch_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kEpoch_s + sample->mocap_stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  recorded.frames = assembler.take();
  return recorded;
}

/// The shipped scenario, slow, horizontal, with a payload: frames in which EI is identifiable.
rig::Scenario slow_scenario() {
  rig::Scenario scenario = shipped_scenario("demo");
  scenario.duration_s = 14.0;
  scenario.mocap.rate_hz = 60.0;
  scenario.mocap.dropout_probability = 0.0;
  scenario.mocap.ring_noise.position_sd_m = 3e-4;
  scenario.pressures.random->highest_hz = 0.06;
  scenario.payload.repeat_s = 0.0;
  scenario.payload.schedule = {{0.0, {0.2}}};
  scenario.mount.q_mocap_base = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY());
  return scenario;
}

arm::Arm arm_with_noise() {
  arm::Arm arm = shipped_arm("online_200mm");
  for (arm::MeasuredBody& body : arm.bodies) body.position_sd_m = 3e-4;
  return arm;
}

struct Result {
  double bias = 0.0;  ///< median of EI over the true one, less 1, over the frames in which it is identifiable
  double coverage = 0.0;  ///< of 95 % intervals
  double milliseconds = 0.0;
  int identifiable = 0, ok = 0;
};

double median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Result estimate(const arm::Arm& arm, const std::vector<model::Present>& effects, const Recorded& recorded) {
  estimate::Estimator estimator(arm, arm.estimator, effects);
  estimator.set_backbone_points(2);
  Result result;
  std::vector<double> ratio, milliseconds;
  int covered = 0;
  for (std::size_t i = 0; i < recorded.frames.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    const estimate::Estimate& e = estimator.estimate(recorded.frames[i]);
    milliseconds.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    result.ok += e.status == estimate::Status::kOk;
    if (e.status != estimate::Status::kOk || recorded.truth[i].stamp_s < 2.0) continue;
    const estimate::SegmentEstimate& segment = e.segments[0];
    if (!segment.identifiable_stiffness) continue;
    const double truth = recorded.truth[i].segments[0].bending_stiffness_nm2;
    ratio.push_back(*segment.bending_stiffness_nm2 / truth);
    covered += std::abs(*segment.bending_stiffness_nm2 - truth) < 1.96 * *segment.sd_bending_stiffness_nm2;
  }
  result.identifiable = static_cast<int>(ratio.size());
  result.bias = median(ratio) - 1.0;
  result.coverage = ratio.empty() ? 0.0 : covered / static_cast<double>(ratio.size());
  result.milliseconds = median(milliseconds);
  return result;
}

struct Case {
  const char* name;
  rig::HiddenChoice hidden;
  arm::EffectEntry entry;
  double least_bias;  ///< of the plain arm
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"constitutive",
       {"rigid_ends", "", {{"base_m", 0.02}, {"tip_m", 0.01}}},
       {"rigid_ends", {{"base_m", 0.02}, {"tip_m", 0.01}}},
       0.05},
      {"boundary",
       {"base_compliance", "", {{"stiffness_nm_per_rad", 5.0}}},
       {"base_compliance", {{"compliance_rad_per_nm", 0.2}}},
       0.05},
      {"load", {"tip_mass", "", {{"mass_kg", 0.04}}}, {"tip_mass", {{"mass_kg", 0.04}}}, 0.05},
      {"actuation",
       {"actuation_taper", "linear", {{"share", 0.15}}},
       {"actuation_taper", {{"share", 0.15}}},
       0.02},
      {"sensor",
       {"marker_bias", "given", {{"body", 2.0}, {"x_m", 0.002}, {"y_m", 0.0}, {"z_m", 0.001}}},
       {"marker_slip", {{"x_m", 0.002}, {"z_m", 0.001}, {"body", 2.0}}},
       0.03},
      {"memory",
       {"creep", "maxwell", {{"share", 0.2}, {"time_s", 3.0}}},
       {"creep", {{"share", 0.2}, {"time_s", 3.0}}},
       0.05},
  };
  return list;
}

class EstimateWithEffects : public ::testing::TestWithParam<Case> {};

TEST_P(EstimateWithEffects, StiffnessIsRightWithTheEffectInTheModel) {
  const Case& c = GetParam();
  const arm::Arm arm = arm_with_noise();
  rig::Scenario scenario = slow_scenario();
  rig::hide(c.hidden, scenario);
  const Recorded recorded = recorded_frames(arm, scenario);
  ASSERT_EQ(recorded.frames.size(), recorded.truth.size());
  const Result plain = estimate(arm, {}, recorded);
  const Result extended = estimate(arm, effects::effects_of(arm, {c.entry}), recorded);
  std::printf(
      "%-14s EI %+6.2f %% -> %+6.2f %%, intervals cover %3.0f %% -> %3.0f %%, identifiable %d -> %d, %.3f -> "
      "%.3f "
      "ms\n",
      c.name, 100.0 * plain.bias, 100.0 * extended.bias, 100.0 * plain.coverage, 100.0 * extended.coverage,
      plain.identifiable, extended.identifiable, plain.milliseconds, extended.milliseconds);
  EXPECT_EQ(extended.ok, static_cast<int>(recorded.frames.size()));
  ASSERT_GT(extended.identifiable, 200);
  EXPECT_GT(std::abs(plain.bias), c.least_bias);
  EXPECT_LT(std::abs(extended.bias), 0.015);
  EXPECT_LT(std::abs(extended.bias), 0.25 * std::abs(plain.bias));
  EXPECT_GT(extended.coverage, 0.9);
}

INSTANTIATE_TEST_SUITE_P(Families, EstimateWithEffects, ::testing::ValuesIn(cases()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace softarm::effects::testing
