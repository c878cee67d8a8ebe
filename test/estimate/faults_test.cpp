// Bodies that are wrong, lost or absurd: a refusal with its reason, or an estimate that does not suffer.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "finite.h"
#include "frames.h"

namespace softarm::estimate::testing {
namespace {

using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Truth plain_truth() {
  return {{{0.3, 0.8, 0.035, 0.203}}, 0.2, hanging()};
}

/// Errors within this many standard deviations of the estimate's own.
void expect_within(const estimate::Estimate& estimate, const Truth& truth, double sds) {
  ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
  const estimate::SegmentEstimate& s = estimate.segments[0];
  const SegmentTruth& t = truth.segments[0];
  EXPECT_LT(std::abs(*s.moment_nm - t.moment_nm), sds * s.sd_moment_nm.value());
  EXPECT_LT(std::abs(std::remainder(*s.direction_rad - t.direction_rad, 2.0 * M_PI)),
            sds * s.sd_direction_rad.value());
  EXPECT_LT(std::abs(*s.bending_stiffness_nm2 - t.bending_stiffness_nm2),
            sds * s.sd_bending_stiffness_nm2.value());
  EXPECT_LT(std::abs(*s.length_m - t.length_m), sds * s.sd_length_m.value());
}

/// Frames of which one ring is 20 mm off in a random direction; each is to be found and to do no harm.
/// @param warm the estimator knows the frame before
void expect_outliers_found(bool warm) {
  const arm::Arm arm = paper_arm();
  const Truth truth = plain_truth();
  const trial::Frame exact = make_frame(arm, truth);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  std::mt19937_64 random(11);
  constexpr int kFrames = 40;
  for (int bad = 0; bad < 4; ++bad) {
    int found = 0;
    for (int i = 0; i < kFrames; ++i) {
      SCOPED_TRACE("ring " + std::to_string(bad + 1) + ", frame " + std::to_string(i));
      estimator.reset();
      if (warm) estimator.estimate(with_noise(arm, exact, random));
      trial::Frame frame = with_noise(arm, exact, random);
      frame.bodies[static_cast<std::size_t>(bad)].p_mocap += 0.02 * normal3(random).normalized();
      const estimate::Estimate& estimate = estimator.estimate(frame);
      expect_finite(estimate);
      bool named = estimate.status == estimate::Status::kOk;
      for (const estimate::BodyResidual& r : estimate.residuals) named = named && r.used == (r.body != bad);
      if (!named) continue;
      ++found;
      expect_within(estimate, truth, 5.0);
      EXPECT_LT(estimate.rms_residual_m, 0.002) << "of the bodies used";
      EXPECT_LT(estimate.reduced_chi_square, 5.0);
    }
    // Along some directions a tip that is off can be explained by an arm of another stiffness and a lesser
    // outlier.
    EXPECT_GE(found, (bad == 3 ? 0.9 : 0.95) * kFrames) << "ring " << bad + 1;
  }
}

TEST(Outlier, IsNamedAndSetAsideInAStream) {
  expect_outliers_found(true);
}

TEST(Outlier, IsNamedAndSetAsideInTheFirstFrame) {
  expect_outliers_found(false);
}

TEST(Outlier, PullsTheFitWhereRobustnessIsOff) {
  const arm::Arm arm = paper_arm();
  arm::EstimatorOptions options = with_method(arm::Method::kFullPoints);
  options.robust = false;
  trial::Frame frame = make_frame(arm, plain_truth());
  frame.bodies[1].p_mocap += Vector3d(0.02, 0.0, 0.0);
  const estimate::Estimate estimate = estimate::Estimator(arm, options).estimate(frame);
  ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
  for (const estimate::BodyResidual& r : estimate.residuals) EXPECT_TRUE(r.used);
  EXPECT_GT(estimate.rms_residual_m, 0.003);
  EXPECT_GT(estimate.reduced_chi_square, 20.0)
      << "the stated noise does not explain it, and the estimate says so";
}

TEST(MissingBodies, TwoOfFourAreNotMissed) {
  const arm::Arm arm = paper_arm();
  const Truth truth = plain_truth();
  std::mt19937_64 random(12);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const trial::Frame whole = with_noise(arm, make_frame(arm, truth), random);
  const double sd_of_all = estimator.estimate(whole).segments[0].sd_bending_stiffness_nm2.value();
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      trial::Frame frame = whole;
      frame.bodies.erase(frame.bodies.begin() + b);
      frame.bodies.erase(frame.bodies.begin() + a);
      estimator.reset();
      const estimate::Estimate& estimate = estimator.estimate(frame);
      SCOPED_TRACE(std::to_string(a + 1) + " and " + std::to_string(b + 1) + " missing");
      expect_finite(estimate);
      if (a == 2 && estimate.status == estimate::Status::kNotEnoughBodies)
        continue;  // the distal half of the arm is unseen
      ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
      EXPECT_EQ(estimate.residuals.size(), 2u);
      const estimate::SegmentEstimate& s = estimate.segments[0];
      if (s.identifiable_stiffness) expect_within(estimate, truth, 4.0);
      EXPECT_GT(s.sd_bending_stiffness_nm2.value_or(1.0), sd_of_all);
    }
  }
}

TEST(MissingBodies, OneRingIsTooFew) {
  const arm::Arm arm = paper_arm();
  trial::Frame frame = make_frame(arm, plain_truth());
  for (int i = 0; i < 4; ++i) {
    trial::Frame one = frame;
    one.bodies = {frame.bodies[static_cast<std::size_t>(i)]};
    estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
    EXPECT_EQ(estimator.estimate(one).status, estimate::Status::kNotEnoughBodies);
    expect_finite(estimator.estimate(one));
  }
  frame.bodies.clear();
  EXPECT_EQ(estimate::Estimator(arm, with_method(arm::Method::kFullPoints)).estimate(frame).status,
            estimate::Status::kNotEnoughBodies);
}

TEST(MissingBodies, AnArmOfOneRingIsToldThatItNeedsMoreWithoutThePrior) {
  arm::Arm arm = paper_arm();
  arm.bodies.resize(1);
  const trial::Frame frame = make_frame(arm, plain_truth());
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const estimate::Estimate& one = estimator.estimate(frame);
  EXPECT_EQ(one.status, estimate::Status::kNotEnoughBodies);
  EXPECT_EQ(one.detail,
            "1 of 1 bodies can be used, and without the prior more are needed than there are segments");
}

TEST(MissingBodies, TheBaseIsHeldWhileLostIfTheArmSaysSo) {
  arm::Arm arm = paper_arm();
  const Truth truth = plain_truth();
  trial::Frame frame = make_frame(arm, truth);
  trial::Frame lost = frame;
  lost.base_body.reset();
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  EXPECT_EQ(estimator.estimate(lost).status, estimate::Status::kNoBasePose);
  expect_finite(estimator.estimate(lost));
  EXPECT_EQ(estimator.estimate(frame).status, estimate::Status::kOk);
  EXPECT_EQ(estimator.estimate(lost).status, estimate::Status::kOk);
  lost.base_body = frame.base_body;
  lost.base_body->translation().x() = kNan;
  EXPECT_EQ(estimator.estimate(lost).status, estimate::Status::kOk);
  estimator.reset();
  EXPECT_EQ(estimator.estimate(lost).status, estimate::Status::kNoBasePose);

  arm.base.hold_last = false;
  estimate::Estimator strict(arm, with_method(arm::Method::kFullPoints));
  EXPECT_EQ(strict.estimate(frame).status, estimate::Status::kOk);
  EXPECT_EQ(strict.estimate(lost).status, estimate::Status::kNoBasePose);
  EXPECT_NE(strict.estimate(lost).detail.find("base"), std::string::npos);
}

TEST(AbsurdNumbers, OfSomeBodiesAreLeftOut) {
  const arm::Arm arm = paper_arm();
  const Truth truth = plain_truth();
  for (const double absurd : {kNan, kInfinity, -kInfinity, 1e3, 1e300}) {
    for (std::size_t i = 0; i < 4; ++i) {
      trial::Frame frame = make_frame(arm, truth);
      frame.bodies[i].p_mocap.y() = absurd;
      estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
      const estimate::Estimate& estimate = estimator.estimate(frame);
      expect_finite(estimate);
      expect_within(estimate, truth, 1.0);
      EXPECT_EQ(estimate.residuals.size(), 3u);
      const bool is_place = std::isfinite(absurd);
      ASSERT_EQ(estimate.too_far.size(), is_place ? 1u : 0u);
      if (!is_place) continue;
      EXPECT_EQ(estimate.too_far.front().body, static_cast<int>(i));
      EXPECT_NEAR(estimate.too_far.front().distance_m / absurd, 1.0, 1e-3);
    }
  }
}

TEST(AbsurdNumbers, ABodyTooFarIsSaidWhetherOrNotTheOthersSuffice) {
  const arm::Arm arm = two_segment_arm();
  const Truth truth{{{0.3, 0.8, 0.035, 0.2}, {0.1, 0.2, 0.02, 0.15}}, 0.1, hanging()};
  const trial::Frame whole = make_frame(arm, truth);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const double reduced_chi_square = estimator.estimate(whole).reduced_chi_square;
  EXPECT_TRUE(estimator.estimate(whole).too_far.empty());

  trial::Frame frame = whole;
  frame.bodies[1].p_mocap.x() += 12.0;
  const estimate::Estimate& one = estimator.estimate(frame);
  expect_finite(one);
  ASSERT_EQ(one.status, estimate::Status::kOk) << one.detail;
  ASSERT_EQ(one.too_far.size(), 1u);
  EXPECT_EQ(one.too_far.front().body, 1);
  EXPECT_NEAR(one.too_far.front().distance_m, 12.0, 0.3);
  // No statistics have it in them.
  EXPECT_EQ(one.residuals.size(), 5u);
  for (const estimate::BodyResidual& r : one.residuals) EXPECT_TRUE(r.used && r.body != 1);
  EXPECT_LT(one.rms_residual_m, 1e-3);
  EXPECT_LT(one.reduced_chi_square, reduced_chi_square + 1.0);

  for (std::size_t i = 3; i < 6; ++i) frame.bodies[i].p_mocap.x() += 12.0;  // the whole distal segment
  frame.bodies[1] = whole.bodies[1];
  const estimate::Estimate& refused = estimator.estimate(frame);
  EXPECT_EQ(refused.status, estimate::Status::kNotEnoughBodies);
  EXPECT_EQ(refused.too_far.size(), 3u);
  EXPECT_NE(refused.detail.find("too few towards the tip"), std::string::npos) << refused.detail;
  for (const char* words :
       {"'ring_4' is 12", "'ring_6' is 12", " m from the base, too far for an arm of 0.35 m"})
    EXPECT_NE(refused.detail.find(words), std::string::npos) << refused.detail;
  EXPECT_TRUE(estimator.estimate(whole).too_far.empty());
}

TEST(AbsurdNumbers, OfAllBodiesAreRefused) {
  const arm::Arm arm = paper_arm();
  for (const arm::Method method : {arm::Method::kFullPoints, arm::Method::kEndOrientation,
                                   arm::Method::kCcPoints, arm::Method::kCcEndpoint}) {
    for (const double absurd : {kNan, kInfinity, -kInfinity, 1e3, 1e300}) {
      trial::Frame frame = make_frame(arm, plain_truth());
      for (trial::BodyObservation& seen : frame.bodies) seen.p_mocap.z() = absurd;
      estimate::Estimator estimator(arm, with_method(method));
      const estimate::Estimate& estimate = estimator.estimate(frame);
      EXPECT_EQ(estimate.status, estimate::Status::kInvalidInput) << to_string(estimate.status);
      expect_finite(estimate);
    }
  }
}

/// The detail of the refusal of a frame whose lengths are all wrong by one factor; "ok" if there is none.
std::string detail_at_scale(double factor) {
  const arm::Arm arm = paper_arm();
  trial::Frame frame = make_frame(arm, plain_truth());
  const Vector3d base = frame.base_body ? Vector3d(frame.base_body->translation())
                                        : Vector3d(arm.base.fixed_pose.translation());
  for (trial::BodyObservation& seen : frame.bodies) seen.p_mocap = base + factor * (seen.p_mocap - base);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const estimate::Estimate& estimate = estimator.estimate(frame);
  return estimate.status == estimate::Status::kOk ? "ok" : estimate.detail;
}

TEST(AbsurdNumbers, WrongUnitsAreNamedWithBothLengths) {
  EXPECT_EQ(detail_at_scale(1.0), "ok");
  for (const double factor : {1e-3, 0.1, 10.0, 1e3}) {
    const std::string detail = detail_at_scale(factor);
    SCOPED_TRACE(detail);
    EXPECT_NE(detail.find("inputs.bodies.unit"), std::string::npos);
    EXPECT_NE(detail.find(" 0.2 m"), std::string::npos) << "the arm's length";
  }
}

TEST(AbsurdNumbers, OfOrientationsPayloadAndPressuresNeverShow) {
  const arm::Arm arm = paper_arm();
  for (const arm::Method method : {arm::Method::kFullPoints, arm::Method::kEndOrientation,
                                   arm::Method::kCcPoints, arm::Method::kCcEndpoint}) {
    for (const double absurd : {kNan, kInfinity, 0.0}) {
      trial::Frame frame = make_frame(arm, plain_truth());
      for (trial::BodyObservation& seen : frame.bodies) seen.q_mocap->coeffs().setConstant(absurd);
      expect_finite(estimate::Estimator(arm, with_method(method)).estimate(frame));
    }
    for (const double absurd : {kNan, kInfinity, 1e12, -1e12}) {
      trial::Frame frame = make_frame(arm, plain_truth());
      frame.payload_kg = absurd;
      expect_finite(estimate::Estimator(arm, with_method(method)).estimate(frame));
      frame = make_frame(arm, plain_truth());
      frame.payload_kg.reset();
      frame.inputs = {absurd, absurd, absurd};
      expect_finite(estimate::Estimator(arm, with_method(method, arm::Unknown::kPayload)).estimate(frame));
    }
  }
}

TEST(AbsurdNumbers, AShapeThatNoArmTakesIsRefused) {
  const arm::Arm arm = paper_arm();
  std::mt19937_64 random(13);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    trial::Frame frame = make_frame(arm, plain_truth());
    for (trial::BodyObservation& seen : frame.bodies) {
      seen.body = (seen.body + i) % 5;  // 4 is no body of this arm
      seen.p_mocap = 0.12 * normal3(random);
    }
    const estimate::Estimate& estimate = estimator.estimate(frame);
    expect_finite(estimate);
    refused += estimate.status == estimate::Status::kOk ? 0 : 1;
  }
  EXPECT_GT(refused, 100);
  // And the next good frame is as good as ever.
  expect_within(estimator.estimate(make_frame(arm, plain_truth())), plain_truth(), 1.0);
}

}  // namespace
}  // namespace softarm::estimate::testing
