// The baselines of the proof that choose among signatures: known answers of small linear problems.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "prove/deciders.h"

namespace softarm::prove {
namespace {

using ::testing::ElementsAre;

/// Three signatures, the second almost the first; the residual is z times the first, and noise.
Candidates candidates(double z, double cosine) {
  Candidates list;
  list.names = {"first", "second", "third"};
  list.gram.setIdentity(3, 3);
  list.gram(0, 1) = list.gram(1, 0) = cosine;
  list.score = Eigen::Vector3d(z, cosine * z, 0.5);
  list.numbers = Eigen::Vector3i::Ones();
  list.rows = 10000.0;
  return list;
}

TEST(BicStepwise, TakesWhatIsThereAndNothingElse) {
  const Decision found = bic_stepwise(candidates(12.0, 0.5));
  ASSERT_EQ(found.effects.size(), 1u);
  EXPECT_EQ(found.effects[0].effect, "first");
  EXPECT_GT(*found.effects[0].probability, 0.99);
  EXPECT_THAT(found.ranking, ElementsAre("first", "second", "third"));
  EXPECT_TRUE(found.alarm);
  // ln 10000 = 9.2: a z of 3 is not worth a number.
  const Decision nothing = bic_stepwise(candidates(3.0, 0.5));
  EXPECT_FALSE(nothing.alarm);
  EXPECT_TRUE(nothing.effects.empty());
}

TEST(BicStepwise, IsUnsureBetweenTwoThatAreAlike) {
  const Decision found = bic_stepwise(candidates(12.0, 0.999));
  ASSERT_EQ(found.effects.size(), 1u);
  EXPECT_LT(*found.effects[0].probability, 0.6);
}

TEST(BicStepwise, TakesTwo) {
  Candidates both = candidates(12.0, 0.0);
  both.score[2] = -9.0;
  const Decision found = bic_stepwise(both);
  ASSERT_EQ(found.effects.size(), 2u);
  EXPECT_EQ(found.effects[0].effect, "first");
  EXPECT_EQ(found.effects[1].effect, "third");
}

TEST(Lasso, IsSoftThresholdingWhereSignaturesAreOrthogonal) {
  const Eigen::VectorXd x =
      lasso_at(Eigen::Matrix3d::Identity(), Eigen::Vector3d(5.0, -1.0, -4.0), 1.5, Eigen::Vector3d::Zero());
  EXPECT_TRUE(x.isApprox(Eigen::Vector3d(3.5, 0.0, -2.5), 1e-9)) << x.transpose();
}

TEST(Lasso, MeetsItsConditionsOfOptimality) {
  Eigen::Matrix3d gram;
  gram << 1.0, 0.7, 0.2, 0.7, 1.0, -0.3, 0.2, -0.3, 1.0;
  const Eigen::Vector3d score(4.0, 5.0, -3.0);
  const double penalty = 0.8;
  const Eigen::VectorXd x = lasso_at(gram, score, penalty, Eigen::Vector3d::Zero());
  const Eigen::VectorXd slope = score - gram * x;
  for (int j = 0; j < 3; ++j) {
    EXPECT_LE(std::abs(slope[j]), penalty + 1e-6);
    if (x[j] == 0.0) continue;
    EXPECT_NEAR(slope[j], std::copysign(penalty, x[j]), 1e-6);
  }
}

TEST(Lasso, NamesTheStrongest) {
  const Decision found = lasso(candidates(12.0, 0.5));
  ASSERT_FALSE(found.effects.empty());
  EXPECT_EQ(found.effects[0].effect, "first");
  EXPECT_FALSE(lasso(candidates(1.0, 0.5)).alarm);
}

}  // namespace
}  // namespace softarm::prove
