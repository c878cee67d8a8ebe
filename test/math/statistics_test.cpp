#include "math/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace softarm::math {
namespace {

std::vector<double> shuffled(int count, std::uint64_t seed) {
  std::vector<double> values(static_cast<std::size_t>(count));
  std::iota(values.begin(), values.end(), 0.0);
  std::shuffle(values.begin(), values.end(), std::mt19937_64(seed));
  return values;
}

TEST(Statistics, TheMedianIsTheMiddleInAnyOrder) {
  EXPECT_EQ(median({3.0, -1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0}), 2.5);
  EXPECT_EQ(median({7.0}), 7.0);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_EQ(median(shuffled(101, seed)), 50.0);
    EXPECT_EQ(median(shuffled(100, seed)), 49.5);
  }
}

TEST(Statistics, AQuantileIsTheValueOfTheNearestRank) {
  const std::vector<double> values = shuffled(101, 1);
  EXPECT_EQ(quantile(values, 0.0), 0.0);
  EXPECT_EQ(quantile(values, 0.25), 25.0);
  EXPECT_EQ(quantile(values, 0.984), 98.0);
  EXPECT_EQ(quantile(values, 1.0), 100.0);
}

TEST(Statistics, OfNothingAllIsZero) {
  EXPECT_EQ(median({}), 0.0);
  EXPECT_EQ(quantile({}, 0.3), 0.0);
  EXPECT_EQ(mean({}), 0.0);
  EXPECT_EQ(robust_sd({}), 0.0);
}

TEST(Statistics, WildValuesDoNotWidenTheRobustSpread) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(5.0, 0.3);
  std::vector<double> values(20000);
  for (double& v : values) v = normal(random);
  EXPECT_NEAR(mean(values), 5.0, 0.01);
  EXPECT_NEAR(robust_sd(values), 0.3, 0.01);
  std::fill_n(values.begin(), 1000, 1e6);
  EXPECT_NEAR(robust_sd(values), 0.3, 0.03);
}

}  // namespace
}  // namespace softarm::math
