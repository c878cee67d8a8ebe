// The estimator on the rig's data, which another model of the arm made: stiffness and payload at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "frames.h"
#include "math/distributions.h"
#include "rig/simulator.h"
#include "trial/frame_assembler.h"

namespace softarm::estimate::testing {
namespace {

constexpr double kEpoch_s = 100.0;

struct RigTrial {
  std::vector<trial::Frame> frames;
  std::vector<rig::Truth> truth;  ///< one per frame
};

/// @param seed of another trial of the same kind; absent: the scenario's
RigTrial record(const arm::Arm& arm, const std::string& scenario, double duration_s,
                std::optional<std::uint64_t> seed = std::nullopt) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/scenarios/" + scenario + ".yaml");
  std::stringstream text;
  text << file.rdbuf();
  rig::Scenario spec = rig::parse_scenario(text.str(), scenario);
  spec.duration_s = duration_s;
  spec.seed = seed.value_or(spec.seed);
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
  const arm::Arm arm = placed_exactly(paper_arm());
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

constexpr std::size_t kErrors = 5;

/// Normal numbers, as evenly spread as so few can be: a Latin hypercube. Few arms drawn freely would differ
/// more among each other than coverage may.
std::vector<std::array<double, kErrors>> spread_errors(int arms, std::mt19937_64& random) {
  std::vector<std::array<double, kErrors>> errors(static_cast<std::size_t>(arms));
  std::vector<double> values(errors.size());
  for (std::size_t of = 0; of < kErrors; ++of) {
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = math::normal_quantile((static_cast<double>(k) + 0.5) / arms);
    std::shuffle(values.begin(), values.end(), random);
    for (std::size_t k = 0; k < values.size(); ++k) errors[k][of] = values[k];
  }
  return errors;
}

struct Covered {
  int payload = 0, stiffness = 0, count = 0;
};

/// Every n-th frame of the trial by an arm file that is wrong: EI and each chamber's gain by 3 %, the
/// length by 1 mm, bodies by 0.5 mm, which is what the file says of itself.
Covered by_wrong_arm(const RigTrial& trial, arm::Arm arm, double window_s, std::size_t every,
                     const std::array<double, kErrors>& errors, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  arm::EstimatorOptions options = arm.estimator;
  options.unknown = arm::Unknown::kBoth;
  options.window_s = window_s;
  options.prior.enabled = true;
  options.prior.moment_sd_nm = 0.005;
  options.prior.moment_sd_rel = 0.03;
  options.prior.bending_stiffness_sd_rel = 0.03;
  arm::Segment& segment = arm.segments[0];
  const double stiffness = 1.0 + 0.03 * errors[0];
  for (std::size_t i = 0; i < segment.chambers.size(); ++i)
    segment.chambers[i].moment_gain_nm_per_pa *= 1.0 + 0.03 * errors[2 + i];
  segment.bending_stiffness.base_nm2 *= stiffness;
  segment.bending_stiffness.per_min_pressure_nm2_per_pa *= stiffness;
  segment.length_m += 0.001 * errors[1];
  for (arm::MeasuredBody& body : arm.bodies) {
    body.arclength_m = std::min(body.arclength_m, segment.length_m);
    body.section_in_body.translation() =
        0.0005 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    body.placement_sd_m = 0.0005;
  }
  arm.payload.arclength_m = segment.length_m;
  estimate::Estimator estimator(arm, options);
  estimator.set_backbone_points(0);
  Covered covered;
  double last_change_s = -10.0, last_kg = -1.0;
  for (std::size_t i = 0; i < trial.frames.size(); ++i) {
    const rig::Truth& truth = trial.truth[i];
    if (truth.payload_kg != last_kg || truth.payload_steadied) last_change_s = truth.stamp_s;
    last_kg = truth.payload_kg;
    if (i % every != 0) continue;
    const estimate::Estimate& estimate = estimator.estimate(trial.frames[i]);
    const bool at_rest = truth.stamp_s < 3.0 || truth.stamp_s > 57.0;
    if (estimate.status != estimate::Status::kOk || at_rest || truth.stamp_s < last_change_s + window_s)
      continue;
    // An estimate cannot be below no payload: there an interval of 95 % covers more.
    if (truth.payload_kg == 0.0) continue;
    const estimate::SegmentEstimate& of = estimate.segments[0];
    ++covered.count;
    covered.payload +=
        std::abs(*estimate.payload_kg - truth.payload_kg) < 1.96 * estimate.sd_payload_kg.value();
    covered.stiffness += std::abs(*of.bending_stiffness_nm2 - truth.segments[0].bending_stiffness_nm2) <
                         1.96 * of.sd_bending_stiffness_nm2.value();
  }
  return covered;
}

TEST(OnTheRig, IntervalsCoverWhenLawsAndPlacesOfBodiesErr) {
  const arm::Arm arm = paper_arm();
  std::vector<RigTrial> trials;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) trials.push_back(record(arm, "trial_both", 60.0, seed));
  constexpr int kArms = 32;
  constexpr std::size_t kEvery = 6;
  for (const double window_s : {0.5, 5.0}) {
    SCOPED_TRACE(window_s);
    std::mt19937_64 random(71);
    const std::vector<std::array<double, kErrors>> errors = spread_errors(kArms, random);
    Covered all;
    for (std::size_t k = 0; k < kArms; ++k) {
      const Covered one = by_wrong_arm(trials[k % trials.size()], arm, window_s, kEvery, errors[k], random);
      all.payload += one.payload;
      all.stiffness += one.stiffness;
      all.count += one.count;
    }
    const auto count = static_cast<double>(all.count);
    const std::string of = window_s < 1.0 ? "_of_short_window" : "_of_long_window";
    RecordProperty("payload" + of, std::to_string(all.payload / count));
    RecordProperty("stiffness" + of, std::to_string(all.stiffness / count));
    EXPECT_GE(all.payload, 0.90 * count);
    EXPECT_LE(all.payload, 0.97 * count);
    EXPECT_GE(all.stiffness, 0.90 * count);
    EXPECT_LE(all.stiffness, 0.97 * count);
  }
}

}  // namespace
}  // namespace softarm::estimate::testing
