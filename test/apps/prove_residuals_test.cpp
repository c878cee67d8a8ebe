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
  residuals[0][{29, 1}] = Vector3d(7.0, 7.0, 7.0);
  const Residuals at = at_times_of(others, residuals);
  ASSERT_EQ(at.size(), 1u);
  ASSERT_EQ(at[0].size(), 2u)
      << "nothing is made up between neighbours that are far apart, nor beyond the last";
  EXPECT_EQ(at[0].at({10, 1}), Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(at[0].at({12, 1}), Vector3d(2.0, 0.0, 2.0));
}

TEST(ProveResiduals, DisplacementsAreOfBodiesAtWholeSeconds) {
  Residuals with(1), without(1);
  for (int tick = 56; tick <= 124; tick += 4) {  // every three seconds: at 60 and 120
    with[0][{tick, 1}] = Vector3d(tick, 1.0, 0.0);
    without[0][{tick, 1}] = Vector3d(0.0, 1.0, 0.0);
    with[0][{tick, -1}] = Vector3d::Ones();  // a tangent
  }
  with[0][{60, 2}] = Vector3d::Ones();  // not in both
  const Residuals moved = at_whole_seconds(differences(with, without));
  ASSERT_EQ(moved[0].size(), 2u);
  EXPECT_EQ(moved[0].at({60, 1}), Vector3d(60.0, 0.0, 0.0));
  EXPECT_EQ(moved[0].at({120, 1}), Vector3d(120.0, 0.0, 0.0));
}

}  // namespace
}  // namespace softarm::prove
