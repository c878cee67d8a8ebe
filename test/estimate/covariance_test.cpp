// The stated covariance against the scatter of estimates over noise.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "frames.h"

namespace softarm::estimate::testing {
namespace {

constexpr int kRepetitions = 400;

/// Errors of (M0, phi, EI, L) over repetitions, and the mean of their stated covariances, along the tangent.
struct Scatter {
  Eigen::Matrix4d sample = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d stated = Eigen::Matrix4d::Zero();
  double mean_nees = 0.0;  ///< normalised estimation error squared; 4 is ideal
};

Scatter scatter(const arm::Arm& arm, const arm::EstimatorOptions& options, const Truth& truth) {
  std::mt19937_64 random(17);
  estimate::Estimator estimator(arm, options);
  estimator.set_backbone_points(0);
  const trial::Frame exact = make_frame(arm, truth);
  const SegmentTruth& t = truth.segments[0];
  Scatter result;
  for (int i = 0; i < kRepetitions; ++i) {
    const estimate::Estimate& estimate = estimator.estimate(with_noise(arm, exact, random));
    if (estimate.status != estimate::Status::kOk) throw std::runtime_error(estimate.detail);
    const estimate::SegmentEstimate& s = estimate.segments[0];
    Eigen::Vector4d error(*s.moment_nm - t.moment_nm,
                          std::remainder(*s.direction_rad - t.direction_rad, 2.0 * M_PI),
                          *s.bending_stiffness_nm2 - t.bending_stiffness_nm2, *s.length_m - t.length_m);
    result.sample += error * error.transpose() / kRepetitions;
    const Eigen::Vector4d along(1.0 / upwards(s), 1.0, 1.0 / upwards(s), 1.0);
    const Eigen::Matrix4d stated = along.asDiagonal() * s.covariance * along.asDiagonal();
    result.stated += stated / kRepetitions;
    result.mean_nees += error.dot(stated.ldlt().solve(error)) / kRepetitions;
  }
  return result;
}

Truth told_truth() {
  return {{{0.35, 0.8, 0.035, 0.203}}, 0.22, hanging()};
}

TEST(Covariance, OfLeastSquaresIsThatOfTheSample) {
  const Scatter s = scatter(paper_arm(), with_method(arm::Method::kFullPoints), told_truth());
  // A variance from n = 400 has the relative sd sqrt(2 / n) = 7.1 %; four of them, each at 3.5 sd.
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(s.sample(k, k) / s.stated(k, k), 1.0, 0.25) << k;
  // Chi-square of 4 degrees of freedom: mean 4, sd of the mean sqrt(8 / n) = 0.14. It also sees the
  // correlations.
  EXPECT_NEAR(s.mean_nees, 4.0, 0.5);
}

TEST(Covariance, OfEndOrientationIsThatOfTheSample) {
  const arm::Arm arm = paper_arm();
  arm::Arm sharp = arm;
  for (arm::MeasuredBody& body : sharp.bodies) body.orientation_sd_rad = 0.005;
  const Scatter s = scatter(sharp, with_method(arm::Method::kEndOrientation), told_truth());
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(s.sample(k, k) / s.stated(k, k), 1.0, 0.25) << k;
  EXPECT_NEAR(s.mean_nees, 4.0, 0.5);
}

TEST(Covariance, OfThePapersWeightsIsThatOfTheEstimatorNotOfTheBestOne) {
  arm::EstimatorOptions options = with_method(arm::Method::kFullPoints);
  options.weights = arm::Weights::kPaper;
  const Scatter paper = scatter(paper_arm(), options, told_truth());
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(paper.sample(k, k) / paper.stated(k, k), 1.0, 0.25) << k;
  const Scatter best = scatter(paper_arm(), with_method(arm::Method::kFullPoints), told_truth());
  for (int k = 0; k < 4; ++k) EXPECT_GT(paper.stated(k, k), best.stated(k, k)) << k;
}

TEST(Covariance, OfTheSumOfDistancesIsOfTheRightSize) {
  arm::EstimatorOptions options = with_method(arm::Method::kFullPoints);
  options.objective = arm::Objective::kSumOfDistances;
  const Scatter s = scatter(paper_arm(), options, told_truth());
  // Asymptotic: with four points it holds roughly.
  for (int k = 0; k < 4; ++k) {
    EXPECT_GT(s.sample(k, k) / s.stated(k, k), 0.5) << k;
    EXPECT_LT(s.sample(k, k) / s.stated(k, k), 2.0) << k;
  }
}

}  // namespace
}  // namespace softarm::estimate::testing
