// By how much effects move the bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "model/prepared_trial.h"
#include "prove/displacement.h"
#include "recorded_case.h"

namespace softarm::prove {
namespace {

TEST(ProveDisplacement, AMassMovesBodiesTheWayItPulls) {
  const auto plain = diagnose::testing::recorded_case("{count_weights: [1]}", 3, 3, 8.0);
  const model::Effect* mass = effects::find("tip_mass");
  model::Present present{mass, Eigen::VectorXd::Constant(1, 0.02), {}, Eigen::VectorXd::Constant(1, 0.005)};
  const std::vector<Displacement> moved = displacements(plain.arm, {present}, plain.trials, 0);
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].effect, "tip_mass");
  EXPECT_NEAR(moved[0].relative_sd.value(), 0.25, 1e-12);
  const model::Prepared prepared = model::prepare(plain.arm, plain.trials);
  double along = 0.0, square = 0.0;
  ASSERT_EQ(moved[0].by.size(), prepared.trials.size());
  for (std::size_t t = 0; t < moved[0].by.size(); ++t) {
    const Eigen::Vector3d down = prepared.trials[t].blocks.front().gravity_base.normalized();
    for (const auto& [key, by] : moved[0].by[t]) {
      along += by.dot(down);
      square += by.squaredNorm();
    }
  }
  EXPECT_GT(square, 1e-6);
  EXPECT_GT(along, 0.0);
  // A value that is known, and one of which nothing is, have no interval.
  present.sd.setZero();
  EXPECT_FALSE(displacements(plain.arm, {present}, plain.trials, 0)[0].relative_sd);
  present.sd.resize(0);
  EXPECT_FALSE(displacements(plain.arm, {present}, plain.trials, 0)[0].relative_sd);
}

/// An arm that is seen for two seconds of six, at rest, in means of 0.6 s.
TEST(ProveDisplacement, IsOfTheSecondsAtWhichBodiesAreSeen) {
  Residuals seen(1);
  for (const double from_s : {0.0, 6.0, 12.0}) {
    for (const double middle_s : {0.3, 0.9, 1.5}) {
      const auto tick = std::llround((from_s + middle_s) / kTick_s);
      seen[0][{tick, 2}] = Eigen::Vector3d(from_s + middle_s, 0.0, 0.0);
      seen[0][{tick, -3}] = Eigen::Vector3d::Ones();  // a tangent's
    }
  }
  const Residuals at = at_whole_seconds(seen);
  ASSERT_EQ(at[0].size(), 3U);
  for (const auto& [key, residual] : at[0]) {
    EXPECT_EQ(key.second, 2);
    EXPECT_NEAR(residual.x(), static_cast<double>(key.first) * kTick_s, 1e-9);
    EXPECT_EQ(key.first % std::llround(6.0 / kTick_s), std::llround(1.0 / kTick_s));
  }
  // One that is seen all the time, every three seconds.
  Residuals always(1);
  for (std::int64_t tick = 0; tick <= 180; tick += 4) always[0][{tick, 0}].setOnes();
  const Residuals regular = at_whole_seconds(always);
  ASSERT_EQ(regular[0].size(), 4U);
  for (const auto& [key, residual] : regular[0]) EXPECT_EQ(key.first % 60, 0);
}

}  // namespace
}  // namespace softarm::prove
