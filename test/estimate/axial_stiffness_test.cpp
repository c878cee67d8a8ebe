// A payload read off the stretch is as uncertain as EA.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimate/prior.h"
#include "estimate/problem.h"
#include "frames.h"
#include "softarm/arm/laws.h"

namespace softarm::estimate::testing {
namespace {

constexpr double kAxialStiffness_n = 170.0;

/// The paper's arm, of a fabric that 0.4 kg stretches by 4.6 mm, and laws that know its moment badly.
arm::Arm stretching_arm() {
  arm::Arm arm = placed_exactly(paper_arm());
  arm.segments[0].axial_stiffness_n = kAxialStiffness_n;
  arm.segments[0].length_range_m = {0.1, 0.4};
  arm.payload.range_kg = {0.0, 5.0};
  arm::EstimatorOptions& options = arm.estimator;
  options.prior.enabled = true;
  options.prior.moment_sd_nm = 0.05;
  options.prior.moment_jitter_sd_nm = 0.001;
  options.prior.bending_stiffness_sd_rel = 0.15;
  options.prior.length_sd_m = 0.001;
  options.prior.length_jitter_sd_m = 0.0001;
  options.prior.axial_stiffness_sd_rel = 0.3;
  return arm;
}

struct Case {
  arm::Unknown unknown;
  double window_s;
};

struct Coverage {
  int covered = 0, count = 0;
  double share() const { return static_cast<double>(covered) / count; }
};

/// 95 % intervals of the payload, with everything that the prior speaks of drawn from it.
Coverage coverage_of_payload(arm::Arm arm, const Case& which, double believed_sd_rel, int trials) {
  const arm::LawPrior drawn = arm.estimator.prior;
  arm::EstimatorOptions options = arm.estimator;
  options.unknown = which.unknown;
  options.window_s = which.window_s;
  options.prior.axial_stiffness_sd_rel = believed_sd_rel;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto draw = [&](double limit) { return std::clamp(normal(random), -limit, limit); };
  Coverage coverage;
  for (int trial = 0; trial < trials; ++trial) {
    const arm::InputValues inputs{uniform(random, 0.0, 40e3), uniform(random, 0.0, 20e3), 5e3};
    arm::Arm real = arm;
    real.segments[0].axial_stiffness_n = kAxialStiffness_n * (1.0 + drawn.axial_stiffness_sd_rel * draw(2.9));
    const arm::SegmentPrediction law = arm::predict_segment(arm, arm.segments[0], inputs).value();
    const Eigen::Vector2d moment =
        law.moment_nm + drawn.moment_sd_nm * Eigen::Vector2d(normal(random), normal(random));
    const double stiffness_error = drawn.bending_stiffness_sd_rel * draw(2.0);
    const Truth truth{{{moment.norm(), std::atan2(moment.y(), moment.x()),
                        law.bending_stiffness_nm2 * (1.0 + stiffness_error),
                        law.length_m + drawn.length_sd_m * normal(random)}},
                      uniform(random, 0.05, 0.6),
                      hanging()};
    const trial::Frame exact = make_frame(real, truth);
    estimate::Estimator estimator(arm, options);
    estimator.set_backbone_points(0);
    estimate::Estimate estimate;
    for (int i = 0; i < (which.window_s > 0.0 ? 8 : 1); ++i) {
      trial::Frame frame = with_noise(arm, exact, random);
      frame.inputs = inputs;
      frame.payload_kg.reset();
      frame.stamp_ns = trial::to_nanoseconds(1.0 + i / 60.0);
      estimate = estimator.estimate(frame);
    }
    if (estimate.status != estimate::Status::kOk) throw std::logic_error(estimate.detail);
    coverage.covered +=
        std::abs(*estimate.payload_kg - truth.payload_kg) < 1.96 * estimate.sd_payload_kg.value();
    ++coverage.count;
  }
  return coverage;
}

class AxialStiffness : public ::testing::TestWithParam<Case> {};

TEST_P(AxialStiffness, IntervalsOfThePayloadCoverWhenItErrsAsThePriorSays) {
  const arm::Arm arm = stretching_arm();
  const Coverage with = coverage_of_payload(arm, GetParam(), arm.estimator.prior.axial_stiffness_sd_rel, 300);
  EXPECT_GE(with.share(), 0.92);
  EXPECT_LE(with.share(), 0.98);
  RecordProperty("coverage", std::to_string(with.share()));
  const Coverage exact = coverage_of_payload(arm, GetParam(), 0.0, 100);
  EXPECT_LT(exact.share(), 0.9) << "with EA taken for exact they do not";
}

INSTANTIATE_TEST_SUITE_P(Frames, AxialStiffness,
                         ::testing::Values(Case{arm::Unknown::kPayload, 0.0},
                                           Case{arm::Unknown::kPayload, 0.5},
                                           Case{arm::Unknown::kBoth, 0.0}));

/// Straight, hanging, nothing but stretch to show the payload.
estimate::Estimate of_stretch(const arm::EstimatorOptions& options, const arm::Arm& arm, double payload_kg,
                              int frames = 1) {
  const arm::SegmentPrediction law = arm::predict_segment(arm, arm.segments[0], {0.0, 0.0, 0.0}).value();
  const Truth truth{{{0.0, 0.0, law.bending_stiffness_nm2, law.length_m}}, payload_kg, hanging()};
  trial::Frame frame = make_frame(arm, truth);
  frame.inputs = {0.0, 0.0, 0.0};
  frame.payload_kg.reset();
  estimate::Estimator estimator(arm, options);
  estimate::Estimate estimate;
  for (int i = 0; i < frames; ++i) {
    frame.stamp_ns = trial::to_nanoseconds(1.0 + i / 60.0);
    estimate = estimator.estimate(frame);
  }
  return estimate;
}

TEST(AxialStiffnessAlone, APayloadByStretchIsAsUncertainAsItsStiffness) {
  const arm::Arm arm = stretching_arm();
  arm::EstimatorOptions options = arm.estimator;
  options.unknown = arm::Unknown::kPayload;
  const double weight_per_stretch = kAxialStiffness_n / (9.80665 * arm.segments[0].length_m);
  for (const double payload : {0.2, 0.5, 1.0}) {
    const estimate::Estimate estimate = of_stretch(options, arm, payload);
    ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
    EXPECT_NEAR(*estimate.payload_kg, payload, 0.01 * payload);
    // Its own weight stretches it as well: 0.2 m of it, on average half.
    const double own =
        0.5 * arm.segments[0].mass_per_length_kg_m * arm.segments[0].length_m + arm.tip_mass_kg;
    const double by_length = options.prior.length_sd_m * weight_per_stretch;
    EXPECT_NEAR(*estimate.sd_payload_kg, std::hypot(by_length, 0.3 * (payload + own)), 0.05 * payload);
  }
  // The same from the first frame on and after many: no memory of its own.
  EXPECT_NEAR(*of_stretch(options, arm, 0.5, 5).sd_payload_kg, *of_stretch(options, arm, 0.5).sd_payload_kg,
              0.01 * 0.5);
}

TEST(AxialStiffnessAlone, CountsForNothingWhereItIsRigidOrExact) {
  arm::Arm arm = stretching_arm();
  arm::EstimatorOptions options = arm.estimator;
  options.unknown = arm::Unknown::kPayload;
  arm::EstimatorOptions exact = options;
  exact.prior.axial_stiffness_sd_rel = 0.0;
  EXPECT_GT(*of_stretch(options, arm, 0.5).sd_payload_kg, 1.2 * *of_stretch(exact, arm, 0.5).sd_payload_kg);
  arm.segments[0].axial_stiffness_n.reset();
  const estimate::Estimate rigid = of_stretch(options, arm, 0.5), rigid_exact = of_stretch(exact, arm, 0.5);
  EXPECT_EQ(rigid.segments[0].sd_length_m, rigid_exact.segments[0].sd_length_m);
}

TEST(AxialStiffnessAlone, WidensTheLengthByTheStretch) {
  const arm::Arm arm = stretching_arm();
  const arm::LawPrior& prior = arm.estimator.prior;
  const auto predictions = predict(arm, {0.0, 0.0, 0.0}).value();
  estimate::FrameLaw law =
      estimate::frame_law(arm, prior, predictions, {arm.segments[0].bending_stiffness.base_nm2});
  const int column = estimate::Problem::column(0, 3);
  EXPECT_DOUBLE_EQ(law.information[column], 1e6);
  estimate::allow_for_axial_stiffness(prior, {-0.004}, law);
  EXPECT_NEAR(1.0 / law.information[column], 1e-6 + 0.0012 * 0.0012, 1e-15);
  arm::LawPrior off = prior;
  off.enabled = false;
  estimate::FrameLaw without =
      estimate::frame_law(arm, off, predictions, {arm.segments[0].bending_stiffness.base_nm2});
  estimate::allow_for_axial_stiffness(off, {0.004}, without);
  EXPECT_EQ(without.information[column], 0.0);
}

}  // namespace
}  // namespace softarm::estimate::testing
