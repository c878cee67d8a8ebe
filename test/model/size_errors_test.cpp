// What is made of the standard deviations of effects' numbers.
#include "model/size_errors.h"

#include <gtest/gtest.h>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"

namespace softarm::model {
namespace {

/// A place at the tip may be wrong towards the base alone: beyond the tip nothing is another place.
TEST(SizeErrors, APlaceAtTheTipIsOffInwards) {
  const arm::Arm arm = effects::testing::shipped_arm("online_200mm");
  const double length_m = arm.total_length_m(), sd_m = 4e-3;
  for (const double place_m : {length_m, length_m - 0.2 * sd_m}) {
    Present wall{effects::find("contact"), (Values(6) << 100.0, place_m, 0.0, 0.02, 0.0, 0.0).finished()};
    wall.sd = (Values(5) << 0.0, sd_m, 0.0, 0.0, 0.0).finished();
    const SizeErrors errors(arm, {wall});
    ASSERT_EQ(errors.count(), 1);
    EXPECT_NEAR(errors.effects(0)[0].values[1], place_m - sd_m, 1e-12);
    EXPECT_NEAR(errors.scale(0), -1.0, 1e-12);
    EXPECT_NEAR(errors.leaning(Eigen::VectorXd::Constant(1, 2.0))[0].values[1], length_m, 1e-12);
    EXPECT_NEAR(errors.leaning(Eigen::VectorXd::Constant(1, -2.0))[0].values[1], place_m - 2.0 * sd_m, 1e-12);
  }
}

}  // namespace
}  // namespace softarm::model
