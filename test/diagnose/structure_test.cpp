// With what residuals go.
#include "diagnose/structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Structure, OfSeveralColumnsOfOneNameTheLeastIsNoSurprise) {
  constexpr int kTimes = 400;
  constexpr double kChance = 0.1;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int lone = 0, of_three = 0;
  for (int i = 0; i < kTimes; ++i) {
    MatrixXd all(30, 5);
    for (Eigen::Index j = 0; j < all.size(); ++j) all.data()[j] = normal(random);
    const auto p = p_by_name({"lone", "three", "three", "three"}, all.leftCols(4), all.col(4));
    lone += p.at("lone") < kChance;
    of_three += p.at("three") < kChance;
  }
  EXPECT_NEAR(lone, kChance * kTimes, 0.06 * kTimes);
  EXPECT_NEAR(of_three, kChance * kTimes, 0.06 * kTimes);  // the least of three would come to 0.27
}

TEST(Structure, SaysWithWhatErrorsGo) {
  MatrixXd values(20, 3);
  VectorXd error(20);
  for (int i = 0; i < 20; ++i) {
    values.row(i) << i, i % 2, 5.0;
    error[i] = 0.1 * i + 0.3 * (i % 3);
  }
  const auto p = p_by_name({"time", "turn", "held"}, values, error);
  EXPECT_LT(p.at("time"), 1e-4);
  EXPECT_GT(p.at("turn"), 0.2);
  EXPECT_EQ(p.count("held"), 0u) << "it says nothing";
  EXPECT_THAT(p_by_name({"time", "turn", "held"}, values.topRows(5), error.head(5)), ::testing::IsEmpty());
}

}  // namespace
}  // namespace softarm::diagnose
