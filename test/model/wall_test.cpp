// The arm file's wall in the model of a diagnosis: the same state as everywhere.
#include <gtest/gtest.h>

#include <cmath>

#include "effects/body_table.h"

namespace softarm::effects {
namespace {

TEST(ExtendedModel, HasTheWallOfTheArmFile) {
  arm::Arm without = body_testing::shipped("online_200mm");
  for (arm::Chamber& chamber : without.segments[0].chambers)
    chamber.near_elongation_m_per_pa = chamber.far_elongation_m_per_pa = 0.0;
  arm::Arm arm = without;
  arm.segments[0].wall.bending = {{2.0, 0.4}};
  // One chamber from 10 to 40 kPa in no time. Its moment is in proportion: the same as at another pressure.
  const double left = 0.4 * std::exp(-1.0);
  const std::vector<double> pressures{10e3, 40e3, 40e3, 40e3 - left * 30e3};
  std::vector<body_testing::Condition> conditions;
  for (const double pa : pressures) {
    Eigen::VectorXd inputs = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    inputs[0] = pa;
    conditions.push_back({inputs, 0.1, body_testing::horizontal()});
  }
  model::TrialData trial = body_testing::trial_of(arm, conditions);
  ASSERT_EQ(trial.series.t_s.size(), 4);
  trial.series.t_s << 0.0, 1e-9, 2.0, 500.0;
  model::ExtendedModel walled(arm), plain(without);
  std::vector<model::Predicted> with, by_laws;
  walled.predict(arm, {}, model::Dynamics{false, 0.0}, trial, nullptr, with);
  plain.predict(without, {}, model::Dynamics{false, 0.0}, trial, nullptr, by_laws);
  ASSERT_TRUE(with[2].solved && by_laws[2].solved && by_laws[3].solved);
  EXPECT_LT((with[2].p - by_laws[3].p).norm(), 1e-6);
  EXPECT_GT((with[2].p - by_laws[2].p).norm(), 1e-3);
  EXPECT_LT((with[0].p - by_laws[0].p).norm(), 1e-6);
  // Derivatives go by the same rod.
  const auto varied = walled.vary(arm, {}, model::Dynamics{false, 0.0}, trial, with, false);
  EXPECT_LT((varied.values.col(2) - with[2].values).norm(), 1e-12);
  const auto alike = walled.vary(arm, {}, model::Dynamics{false, 0.0}, trial, with, true);
  EXPECT_EQ(alike.values, varied.values);
}

}  // namespace
}  // namespace softarm::effects
