// What a bar says of the time left.
#include "softarm/time_left.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace softarm::app {
namespace {

TEST(TimeLeft, IsCountedDownWhileNothingIsReported) {
  TimeLeft left;
  EXPECT_FALSE(left.seconds(3.0));
  left.reached(0.25, 10.0);
  EXPECT_DOUBLE_EQ(*left.seconds(10.0), 30.0);
  left.reached(0.25, 15.0);
  EXPECT_DOUBLE_EQ(*left.seconds(15.0), 25.0);
  EXPECT_DOUBLE_EQ(*left.seconds(500.0), 3.0) << "late, but not over";
  left.reached(0.5, 20.0);
  EXPECT_DOUBLE_EQ(*left.seconds(20.0), 20.0);
  left.reached(1.0, 40.0);
  EXPECT_FALSE(left.seconds(40.0));
}

TEST(TimeLeft, IsARangeWhereItIsKnownWithinAFactor) {
  EXPECT_EQ(time_left_text(12.3, 1.0), "12 s left");
  EXPECT_EQ(time_left_text(12.0, 1.6), "8 to 19 s left");
  EXPECT_EQ(time_left_text(0.2, 1.6), "0 s left") << "no range of nothing";
}

/// One diagnosis as it went: processor seconds of 53.5, and the share that was reported then. It shows how
/// shares become times, not how right the time left is: others are off by more, which the range is for
/// (doc/diagnose.md).
TEST(TimeLeft, ReplaysTheSharesOfOneDiagnosis) {
  const double whole_s = 53.5;
  const std::vector<std::pair<double, double>> reported{
      {1.1, 0.02},   {2.7, 0.05},   {7.5, 0.14},   {10.2, 0.152}, {11.8, 0.176}, {13.9, 0.2},
      {16.1, 0.236}, {18.2, 0.26},  {21.9, 0.404}, {24.6, 0.416}, {25.7, 0.44},  {27.3, 0.464},
      {27.8, 0.5},   {30.0, 0.524}, {31.6, 0.536}, {34.8, 0.548}, {35.3, 0.608}, {35.8, 0.656},
      {37.5, 0.668}, {40.7, 0.788}, {46.5, 0.87},  {47.6, 0.89},  {48.0, 0.897}, {48.2, 0.9}};
  TimeLeft left;
  std::size_t next = 0;
  for (double now_s = 0.1; now_s < whole_s; now_s += 0.1) {
    for (; next < reported.size() && reported[next].first <= now_s; ++next)
      left.reached(reported[next].second, reported[next].first);
    if (now_s < 0.2 * whole_s) continue;
    const double shortly_s = 0.02 * whole_s;  // the last second is no matter
    const double ratio = (*left.seconds(now_s) + shortly_s) / (whole_s - now_s + shortly_s);
    EXPECT_LT(std::max(ratio, 1.0 / ratio), 1.55) << now_s;
  }
}

}  // namespace
}  // namespace softarm::app
