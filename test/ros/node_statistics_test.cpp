// What the node counts of its estimates.
#include "ros/node_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace softarm {
namespace {

TEST(NodeStatistics, ABodyTooFarIsNamedAndIsNeitherAnOutlierNorTheWorst) {
  estimate::Estimate estimate;
  estimate.status = estimate::Status::kOk;
  estimate.residuals.resize(1);
  estimate.residuals[0].measured_base.x() = 1e-3;
  estimate.too_far = {{1, 12.0}};
  NodeStatistics statistics;
  statistics.add(estimate, 0.0, 0.0, {"ring_1", "ring_2"});
  EXPECT_THAT(statistics.period.too_far_m, ::testing::ElementsAre(::testing::Pair("ring_2", 12.0)));
  EXPECT_THAT(statistics.period.set_aside, ::testing::IsEmpty());
  EXPECT_EQ(statistics.period.outliers, 0u);
  EXPECT_EQ(statistics.period.worst_body, "ring_1");
  EXPECT_DOUBLE_EQ(statistics.period.worst_residual_m, 1e-3);

  // Also where the others do not suffice, and how far at last.
  estimate.status = estimate::Status::kNotEnoughBodies;
  estimate.residuals.clear();
  estimate.too_far = {{1, 13.0}};
  statistics.add(estimate, 0.0, 0.0, {"ring_1", "ring_2"});
  EXPECT_THAT(statistics.period.too_far_m, ::testing::ElementsAre(::testing::Pair("ring_2", 13.0)));
}

}  // namespace
}  // namespace softarm
