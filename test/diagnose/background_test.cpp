// When small departures of everything are what is left.
#include "diagnose/background.h"

#include <gtest/gtest.h>

namespace softarm::diagnose {
namespace {

Unseen off_by(double rms_m) {
  Unseen unseen;
  unseen.total_rms_m = rms_m;
  return unseen;
}

TEST(Background, IsWhatIsLeftWhereItIsAllAndNoMoreThanEveryArmHas) {
  constexpr double kLength_m = 0.2;  // on which such come to half a millimetre
  const auto small_m = small_departures_m(off_by(0.5e-3), off_by(0.3e-3), true, kLength_m);
  ASSERT_TRUE(small_m);
  EXPECT_NEAR(*small_m, 0.4e-3, 1e-9);
  EXPECT_FALSE(small_departures_m(off_by(0.5e-3), off_by(0.3e-3), false, kLength_m))
      << "something else is left";
  EXPECT_FALSE(small_departures_m(off_by(1.0e-3), off_by(0.3e-3), true, kLength_m)) << "no arm has so much";
  EXPECT_TRUE(small_departures_m(off_by(1.0e-3), off_by(0.3e-3), true, 2 * kLength_m));
  EXPECT_EQ(small_departures_m(off_by(0.3e-3), off_by(0.3e-3), true, kLength_m), 0.0);
}

}  // namespace
}  // namespace softarm::diagnose
