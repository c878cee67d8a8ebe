// The estimator on the rig's data, which another model of the arm made: stiffness and payload at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "frames.h"
#include "rig/simulator.h"
#include "trial/frame_assembler.h"

namespace softarm::estimate::testing {
namespace {

constexpr double kEpoch_s = 100.0;

struct RigTrial {
  std::vector<trial::Frame> frames;
  std::vector<rig::Truth> truth;  ///< one per frame
};

RigTrial record(const arm::Arm& arm, const std::string& scenario, double duration_s) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/" + scenario + ".yaml");
  std::stringstream text;
  text << file.rdbuf();
  rig::Scenario spec = rig::parse_scenario(text.str(), scenario);
  spec.duration_s = duration_s;
  rig::Simulator simulator(spec);
  trial::FrameAssembler assembler(arm);
  RigTrial trial;
  while (const auto sample = simulator.next()) {
    trial.truth.push_back(sample->truth);
    if (sample->payload) assembler.add_payload(kEpoch_s + sample->payload->stamp_s, sample->payload->kg);
    for (const rig::InputSample& input : sample->inputs)
      assembler.add_input(input.number, kEpoch_s + input.stamp_s, input.value);
    for (std::size_t i = 0; i < sample->bodies.size(); ++i) {
      if (sample->bodies[i])
        assembler.add_body(static_cast<int>(i) - 1, kEpoch_s + sample->stamp_s, sample->bodies[i]->p,
                           sample->bodies[i]->q);
    }
  }
  assembler.flush();
  trial.frames = assembler.take();
  return trial;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values.at(values.size() / 2);
}

TEST(OnTheRig, StiffnessAndPayloadAtOnceUnderThePriorInAWindow) {
  const arm::Arm arm = paper_arm();
  const RigTrial trial = record(arm, "trial_both", 60.0);
  ASSERT_EQ(trial.frames.size(), trial.truth.size());
  arm::EstimatorOptions options = arm.estimator;
  options.unknown = arm::Unknown::kBoth;
  options.window_s = 0.5;
  options.prior.enabled = true;
  options.prior.moment_sd_nm = 0.005;
  estimate::Estimator estimator(arm, options);
  estimator.set_backbone_points(0);
  std::vector<double> payload, stiffness;
  int covered_payload = 0, covered_stiffness = 0, ok = 0;
  double last_change_s = -10.0, last_kg = -1.0;
  for (std::size_t i = 0; i < trial.frames.size(); ++i) {
    const rig::Truth& truth = trial.truth[i];
    const estimate::Estimate& estimate = estimator.estimate(trial.frames[i]);
    ok += estimate.status == estimate::Status::kOk;
    if (truth.payload_kg != last_kg || truth.payload_steadied) last_change_s = truth.stamp_s;
    last_kg = truth.payload_kg;
    // While a hand is at the payload, and until it has let go for a window's length, the arm is not a free
    // one. At rest there is no moment to bend it.
    const bool at_rest = truth.stamp_s < 3.0 || truth.stamp_s > 57.0;
    if (estimate.status != estimate::Status::kOk || at_rest || truth.stamp_s < last_change_s + 0.5) continue;
    const rig::SegmentTruth& arm_truth = truth.segments[0];
    const estimate::SegmentEstimate& segment = estimate.segments[0];
    ASSERT_TRUE(estimate.sd_payload_kg && segment.sd_bending_stiffness_nm2) << truth.stamp_s;
    payload.push_back(std::abs(*estimate.payload_kg - truth.payload_kg));
    stiffness.push_back(std::abs(*segment.bending_stiffness_nm2 / arm_truth.bending_stiffness_nm2 - 1.0));
    covered_payload += payload.back() < 1.96 * *estimate.sd_payload_kg;
    covered_stiffness += std::abs(*segment.bending_stiffness_nm2 - arm_truth.bending_stiffness_nm2) <
                         1.96 * *segment.sd_bending_stiffness_nm2;
  }
  EXPECT_GE(ok, 0.999 * static_cast<double>(trial.frames.size()) - 2);
  ASSERT_GT(payload.size(), 4000u);
  const auto count = static_cast<double>(payload.size());
  RecordProperty("median_payload_error_g", std::to_string(1e3 * median(payload)));
  RecordProperty("median_stiffness_error_percent", std::to_string(100.0 * median(stiffness)));
  EXPECT_LT(median(payload), 0.005);
  EXPECT_LT(median(stiffness), 0.03);
  EXPECT_GE(covered_payload, 0.92 * count);
  EXPECT_GE(covered_stiffness, 0.92 * count);
}

}  // namespace
}  // namespace softarm::estimate::testing
