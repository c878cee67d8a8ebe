// What spreads among few folds say of an unknown's variance, beside those of the fit's other unknowns.
#include "diagnose/widening.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kUnknowns = 30;

Spread spread_of(const VectorXd& variance, double freedom) {
  return {variance, VectorXd::Ones(variance.size()), VectorXd::Constant(variance.size(), freedom)};
}

std::vector<Index> all() {
  std::vector<Index> rows(kUnknowns);
  std::iota(rows.begin(), rows.end(), Index{0});
  return rows;
}

/// Factors of unknowns that are known to 1 and lie apart by these variances.
VectorXd times(const Spreads& spreads) {
  const Widening widening(spreads, Eigen::MatrixXd::Identity(kUnknowns, kUnknowns));
  return widening.times(spreads, all(), VectorXd::Ones(kUnknowns));
}

/// Draws of unknowns whose true variances are `scale` times an inverse chi^2 of 4 degrees of freedom, or are
/// `scale`, and of their spreads among folds.
struct Draws {
  std::mt19937_64 random{11};
  double scale = 1.0;
  bool scattered = false;
  double freedom = 2.0;

  /// @return share of the 90 % intervals that hold the truth
  double coverage(VectorXd& mean_times) {
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> of_factor(4.0), of_spread(freedom);
    constexpr int kFits = 200;
    int inside = 0;
    mean_times = VectorXd::Zero(kUnknowns);
    for (int fit = 0; fit < kFits; ++fit) {
      VectorXd truth(kUnknowns), seen(kUnknowns);
      for (Index j = 0; j < kUnknowns; ++j) {
        truth[j] = scattered ? scale * 4.0 / of_factor(random) : scale;
        seen[j] = truth[j] * of_spread(random) / freedom;
      }
      const VectorXd factor = times({spread_of(seen, freedom), {}, {}});
      mean_times += factor / kFits;
      for (Index j = 0; j < kUnknowns; ++j)
        inside += std::abs(normal(random)) * std::sqrt(truth[j]) < 1.645 * std::sqrt(factor[j]);
    }
    return static_cast<double>(inside) / (kFits * kUnknowns);
  }
};

TEST(Widening, WithoutFoldsIsNone) {
  EXPECT_EQ(times({}), VectorXd::Ones(kUnknowns));
}

TEST(Widening, OfWhatThePosteriorKnowsIsLittleThoughFoldsAreFew) {
  Draws draws;
  VectorXd factor;
  const double coverage = draws.coverage(factor);
  EXPECT_GT(coverage, 0.88);
  EXPECT_LT(coverage, 0.95);
  EXPECT_LT(factor.mean(), 1.4) << "Student's t of two alone would be 3.15";
}

TEST(Widening, HoldsTheTruthWherePosteriorsAreFarTooSure) {
  Draws draws;
  VectorXd factor;
  draws.scale = 10.0;
  EXPECT_NEAR(draws.coverage(factor), 0.9, 0.04);
  draws.scattered = true;
  EXPECT_NEAR(draws.coverage(factor), 0.9, 0.04);
  draws.freedom = 8.0;
  EXPECT_NEAR(draws.coverage(factor), 0.9, 0.04);
}

/// Among three folds; Student's t alone would make 3.15 of it.
TEST(Widening, OneUnknownAloneIsNoFurtherApartThanStudentsT) {
  const Spreads spreads{spread_of(VectorXd::Ones(1), 2.0), {}, {}};
  const Widening widening(spreads, Eigen::MatrixXd::Identity(1, 1));
  const double factor = widening.times(spreads, {0}, VectorXd::Ones(1))[0];
  EXPECT_GT(factor, 1.0);
  EXPECT_LT(factor, 4.0);
}

TEST(Widening, OneUnknownThatDiffersStandsOut) {
  VectorXd variance = VectorXd::Ones(kUnknowns);
  variance[3] = 60.0;
  const VectorXd factor = times({spread_of(variance, 4.0), {}, {}});
  EXPECT_GT(factor[3], 5.0);
  EXPECT_LT(factor[4], 2.0);
}

TEST(Widening, WhatIsKnownFromBeforeTheTrialsStays) {
  Spreads spreads{spread_of(VectorXd::Constant(kUnknowns, 50.0), 5.0), {}, {}};
  spreads.by_sequence.expected[0] = 0.01;
  spreads.by_sequence.variance[0] = 0.5;  // 50 times what is to be expected
  const VectorXd factor = times(spreads);
  EXPECT_NEAR(factor[1], 50.0, 15.0);
  EXPECT_NEAR(factor[0] - 1.0, 0.01 * (factor[1] - 1.0), 1e-6);
}

TEST(Widening, OfWhatNoTrialTellsIsNone) {
  Spreads spreads{spread_of(VectorXd::Constant(kUnknowns, 5e-4), 2.0), {}, {}};
  spreads.by_sequence.expected.setConstant(5e-4);
  EXPECT_EQ(times(spreads), VectorXd::Ones(kUnknowns));
  EXPECT_EQ(times({spread_of(VectorXd::Zero(kUnknowns), 2.0), {}, {}}), VectorXd::Ones(kUnknowns));
}

TEST(Widening, WhatSequencesAndSessionsBothSayIsAddedButForWhatTrialsSay) {
  const auto of = [](double variance) { return spread_of(VectorXd::Constant(kUnknowns, variance), 1e6); };
  EXPECT_NEAR(times({of(20.0), of(30.0), of(5.0)})[0], 45.0, 0.5);
  EXPECT_NEAR(times({of(20.0), of(30.0), of(40.0)})[0], 30.0, 0.5);
  EXPECT_NEAR(times({of(20.0), {}, of(5.0)})[0], 20.0, 0.5);
  EXPECT_NEAR(times({{}, of(30.0), of(5.0)})[0], 30.0, 0.5);
}

}  // namespace
}  // namespace softarm::diagnose
