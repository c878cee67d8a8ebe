#include <gtest/gtest.h>

#include "prove/residuals.h"

namespace softarm::prove {
namespace {

using Eigen::Vector3d;

TEST(ProveResiduals, AreTakenBetweenNeighboursOfTheSameBody) {
  Residuals others(1), residuals(1);
  for (const int tick : {10, 12, 20, 30}) others[0][{tick, 1}] = Vector3d::Zero();
  residuals[0][{10, 1}] = Vector3d(1.0, 0.0, 0.0);
  residuals[0][{14, 1}] = Vector3d(3.0, 0.0, 4.0);
  residuals[0][{12, 2}] = Vector3d(9.0, 9.0, 9.0);
  residuals[0][{26, 1}] = Vector3d(7.0, 7.0, 7.0);
  const Residuals at = at_times_of(others, residuals);
  ASSERT_EQ(at.size(), 1u);
  ASSERT_EQ(at[0].size(), 2u)
      << "nothing is made up between neighbours that are far apart, nor beyond the last";
  EXPECT_EQ(at[0].at({10, 1}), Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(at[0].at({12, 1}), Vector3d(2.0, 0.0, 2.0));
}

}  // namespace
}  // namespace softarm::prove
