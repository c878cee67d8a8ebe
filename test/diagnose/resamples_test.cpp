// Probabilities averaged over resamples of the trials: as the posterior where trials agree, open where they
// do not, and what one trial alone shows stays.
#include "diagnose/resamples.h"

#include <gtest/gtest.h>

#include <cmath>

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

TEST(Resamples, WeightsAreUniformOverAllOfTheirSum) {
  const MatrixXd weights = bootstrap_weights(9);
  ASSERT_EQ(weights.rows(), 9);
  EXPECT_GT(weights.minCoeff(), 0.0);
  EXPECT_LT((weights.colwise().sum().array() - 9.0).abs().maxCoeff(), 1e-9);
  // Of Dirichlet's distribution of ones: variance (u - 1) / (u + 1), to the accuracy of so many resamples.
  const double variance = (weights.array() - 1.0).square().mean();
  EXPECT_NEAR(variance, 8.0 / 10.0, 0.06);
  EXPECT_EQ(weights, bootstrap_weights(9)) << "the same numbers from the same seed";
}

TEST(Resamples, UnitsAreTrialsAndPiecesOfFewTrials) {
  std::vector<std::size_t> trial;
  for (std::size_t t = 0; t < 8; ++t) trial.insert(trial.end(), 3 + t, t);
  EXPECT_EQ(resampled_units(trial), trial);
  const std::vector<std::size_t> two = {0, 0, 0, 0, 0, 0, 4, 4, 4};
  EXPECT_EQ(resampled_units(two), (std::vector<std::size_t>{0, 0, 1, 1, 2, 2, 3, 4, 5}));
  EXPECT_TRUE(resampled_units({}).empty());
}

TEST(Resamples, WhereTrialsAgreeTheAverageIsThePosterior) {
  const Vector2d log(0.0, -1.0);
  const VectorXd same = averaged_over_resamples(log, MatrixXd::Constant(9, 2, -30.0));
  EXPECT_NEAR(same[0], 1.0 / (1.0 + std::exp(-1.0)), 1e-12);
  EXPECT_NEAR(same.sum(), 1.0, 1e-12);
}

TEST(Resamples, WhereTrialsDisagreeBothStayOpen) {
  MatrixXd by_unit = MatrixXd::Zero(9, 2);
  for (int t = 0; t < 9; ++t) by_unit(t, t < 5 ? 0 : 1) = 50.0;
  const Vector2d log(250.0, 200.0);
  const VectorXd averaged = averaged_over_resamples(log, by_unit);
  EXPECT_GT(averaged[0], 0.5);
  EXPECT_LT(averaged[0], 0.8) << "the posterior itself says 1 - 2e-22";
}

TEST(Resamples, WhatOneTrialAloneShowsStays) {
  MatrixXd by_unit = MatrixXd::Zero(9, 2);
  by_unit(4, 0) = 300.0;
  const VectorXd averaged = averaged_over_resamples(Vector2d(300.0, 0.0), by_unit);
  EXPECT_GT(averaged[0], 0.98);
}

}  // namespace
}  // namespace softarm::diagnose
