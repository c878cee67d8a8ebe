// The estimator against the Cramer-Rao bound, on fewer frames than `estimation_accuracy` takes.
#include "estimate/accuracy.h"

#include <gtest/gtest.h>

#include "frames.h"

namespace softarm::estimate::testing {
namespace {

TEST(Accuracy, ReachesTheCramerRaoBound) {
  estimate::AccuracyProtocol protocol;
  protocol.frames = 1500;
  protocol.seed = 20;
  const estimate::AccuracyReport report = estimate::measure_accuracy(paper_arm(), protocol);
  SCOPED_TRACE(describe(report));
  EXPECT_EQ(report.frames, 1500);
  EXPECT_EQ(report.converged, report.frames);
  ASSERT_GT(report.strong_frames, 900);
  for (std::size_t i = 0; i < estimate::AccuracyReport::kParameters; ++i) {
    SCOPED_TRACE(i);
    // A root mean square over n frames has the relative sd 1 / sqrt(2 n), here at most 2.4 %; the errors of a
    // frame near the horizontal weigh more than others in the mean, so the effective n is smaller: 1.05 and 3
    // sd.
    EXPECT_LT(report.efficiency[i], 1.05 + 3.0 * 0.024);
    EXPECT_GT(report.efficiency[i], 0.95 - 3.0 * 0.024);
    // The median of |z| over n has the sd 0.5 / (sqrt(n) * 2 * pdf(0.6745)) = 0.79 / sqrt(n), here 0.020:
    // 0.62 and 0.73 widened by 1.5 sd (the ideal is 2.7 sd inside).
    EXPECT_GT(report.median_error_over_bound[i], 0.62 - 0.03);
    EXPECT_LT(report.median_error_over_bound[i], 0.73 + 0.03);
    // A coverage of 95 % over n has the sd sqrt(0.95 * 0.05 / n) = 0.56 %: 93 ... 97 % widened by 1.5 sd.
    EXPECT_GT(report.identifiable[i], 1350);
    EXPECT_GT(report.coverage[i], 0.93 - 0.008);
    EXPECT_LT(report.coverage[i], 0.97 + 0.008);
  }
  EXPECT_GT(report.clear, 1000);
  EXPECT_GE(report.clear_claimed, 0.99 * report.clear);
  EXPECT_LT(report.median_shape_error_m, protocol.position_sd_m);
}

TEST(Accuracy, HardlyBentFramesDoNotClaimToTellStiffness) {
  estimate::AccuracyProtocol protocol;
  protocol.frames = 1500;
  protocol.seed = 21;
  protocol.moment_nm = {0.0, 0.2};
  protocol.tip_angle_rad = {0.0349, 0.349};  // 2 ... 20 degrees
  const estimate::AccuracyReport report = estimate::measure_accuracy(paper_arm(), protocol);
  SCOPED_TRACE(describe(report));
  ASSERT_GT(report.hopeless, 500);
  // 1 % of n frames has the sd 0.1 sqrt(n), under 0.4 % of n here: 1 % and 2 sd.
  EXPECT_LT(report.hopeless_claimed, 0.018 * report.hopeless);
}

TEST(Accuracy, DependsOnTheSeedOnly) {
  estimate::AccuracyProtocol protocol;
  protocol.frames = 60;
  protocol.seed = 3;
  const estimate::AccuracyReport first = estimate::measure_accuracy(paper_arm(), protocol);
  const estimate::AccuracyReport again = estimate::measure_accuracy(paper_arm(), protocol);
  EXPECT_EQ(describe(first), describe(again));
  EXPECT_EQ(first.efficiency, again.efficiency);
  protocol.seed = 4;
  EXPECT_NE(first.efficiency, estimate::measure_accuracy(paper_arm(), protocol).efficiency);
}

}  // namespace
}  // namespace softarm::estimate::testing
