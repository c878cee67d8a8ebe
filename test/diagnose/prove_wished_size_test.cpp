// Sizes that are wished for of what is hidden, and which of them count.
#include <gtest/gtest.h>

#include "prove/wished_size.h"

namespace softarm::prove {
namespace {

Signal that_leaves(double leftover_m, double raw_m) {
  Signal signal;
  signal.leftover_m = leftover_m;
  signal.raw_m = raw_m;
  return signal;
}

TEST(ProveWishedSize, WhatCountsIsSeenBesideNoiseAndBackground) {
  const double noise_m = 4e-4;
  EXPECT_TRUE(is_clear(that_leaves(2.1e-4, 1e-3), noise_m, 1e-4));
  EXPECT_FALSE(is_clear(that_leaves(1.9e-4, 1e-3), noise_m, 1e-4)) << "less than half the noise";
  EXPECT_FALSE(is_clear(that_leaves(2.1e-4, 1e-3), noise_m, 3e-4)) << "less than the background";
  EXPECT_TRUE(is_clear(that_leaves(3.1e-4, 1e-3), noise_m, 3e-4));
}

TEST(ProveWishedSize, ScalesByTheRatioUntilItIsNear) {
  const double most_m = 4e-3;
  EXPECT_DOUBLE_EQ(factor_towards(2e-3, most_m, that_leaves(1e-3, 2e-3)), 2.0);
  EXPECT_DOUBLE_EQ(factor_towards(5e-4, most_m, that_leaves(1e-3, 2e-3)), 0.5);
  EXPECT_DOUBLE_EQ(factor_towards(1.05e-3, most_m, that_leaves(1e-3, 2e-3)), 1.0);
  EXPECT_DOUBLE_EQ(factor_towards(0.95e-3, most_m, that_leaves(1e-3, 2e-3)), 1.0);
}

TEST(ProveWishedSize, WhatConstantsAbsorbDoesNotGrowWithoutBound) {
  // Of 6 mm the constants leave 0.1: 2 mm left would move the arm by 120 mm. Three times 4 mm are allowed.
  EXPECT_DOUBLE_EQ(factor_towards(2e-3, 4e-3, that_leaves(1e-4, 6e-3)), 2.0);
  // More than allowed already: back, though less is left than wished for.
  EXPECT_DOUBLE_EQ(factor_towards(2e-3, 4e-3, that_leaves(1e-4, 24e-3)), 0.5);
  // An effect that does nothing as it is grows by a bounded step.
  EXPECT_DOUBLE_EQ(factor_towards(2e-3, 4e-3, that_leaves(0.0, 0.0)), 30.0);
}

}  // namespace
}  // namespace softarm::prove
