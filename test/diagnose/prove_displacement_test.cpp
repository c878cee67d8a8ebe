// By how much effects move the bodies.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace softarm::prove
