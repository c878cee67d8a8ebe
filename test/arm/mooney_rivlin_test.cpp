// Two-term Mooney-Rivlin rubber against values computed by hand.
#include "arm/mooney_rivlin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace softarm {
namespace {

// The ratio of the hybrid paper's Table 2 and that of the slides, a neo-Hookean and an ordinary rubber.
const arm::MooneyRivlin kRubbers[] = {{18.8e3, -14e3}, {277e3, -209e3}, {100e3, 0.0}, {100e3, 50e3}};

TEST(ArmMooneyRivlin, StressAndModulusByHand) {
  const arm::MooneyRivlin rubber{100e3, 50e3};
  EXPECT_DOUBLE_EQ(rubber.initial_modulus_pa(), 900e3);
  // lambda 5/4: 2 (100 + 40) (1.25 - 0.64) = 170.8 kPa; 2 * 100 (1 + 2 * 0.512) + 6 * 50 * 0.4096 = 527.68
  // kPa
  EXPECT_NEAR(rubber.nominal_stress_pa(1.25), 170.8e3, 1e-6);
  EXPECT_NEAR(rubber.cauchy_stress_pa(1.25), 213.5e3, 1e-6);
  EXPECT_NEAR(rubber.tangent_modulus_pa(1.25), 527.68e3, 1e-6);
  // lambda 4/5: 2 (100 + 62.5) (0.8 - 1.5625) = -247.8125 kPa
  EXPECT_NEAR(rubber.nominal_stress_pa(0.8), -247812.5, 1e-6);
  EXPECT_NEAR((arm::MooneyRivlin{277e3, -209e3}).initial_modulus_pa(), 408e3, 1e-9);   // the slides' arm
  EXPECT_NEAR((arm::MooneyRivlin{18.8e3, -14e3}).initial_modulus_pa(), 28.8e3, 1e-9);  // the hybrid paper's
}

/// The slides print 2 (c01 + c10 / lambda) (lambda^2 - 1 / lambda), force per deformed area, their c01 being
/// C10.
TEST(ArmMooneyRivlin, CauchyStressIsTheSlides) {
  const double c01 = 277e3;
  const double c10 = -209e3;
  const arm::MooneyRivlin rubber{c01, c10};
  for (const double stretch : {0.9, 1.05, 1.4}) {
    EXPECT_NEAR(rubber.cauchy_stress_pa(stretch),
                2 * (c01 + c10 / stretch) * (stretch * stretch - 1 / stretch), 1e-6);
  }
}

TEST(ArmMooneyRivlin, TangentIsTheDerivativeOfTheStress) {
  constexpr double kStep = 1e-5;
  for (const arm::MooneyRivlin& rubber : kRubbers) {
    for (const double stretch : {0.6, 0.85, 1.0, 1.01, 1.3, 2.5}) {
      const double difference =
          (rubber.nominal_stress_pa(stretch + kStep) - rubber.nominal_stress_pa(stretch - kStep)) /
          (2 * kStep);
      EXPECT_NEAR(rubber.tangent_modulus_pa(stretch), difference, 1e-7 * rubber.c10_pa) << stretch;
    }
    EXPECT_NEAR(rubber.tangent_modulus_pa(1.0), rubber.initial_modulus_pa(), 1e-9 * rubber.c10_pa);
    EXPECT_DOUBLE_EQ(rubber.nominal_stress_pa(1.0), 0.0);
  }
}

TEST(ArmMooneyRivlin, StretchAtInvertsTheStress) {
  for (const arm::MooneyRivlin& rubber : kRubbers) {
    for (const double stretch : {0.88, 0.95, 0.9999, 1.0, 1.0001, 1.02, 1.3, 3.0, 15.0}) {
      const auto found = rubber.stretch_at(rubber.nominal_stress_pa(stretch));
      ASSERT_TRUE(found) << stretch;
      EXPECT_NEAR(*found, stretch, 1e-10 * stretch);
    }
  }
}

/// Where the tangent modulus vanishes, no further stress can be borne.
TEST(ArmMooneyRivlin, NothingBeyondTheLimit) {
  // Hybrid paper, compressed: at a stretch of 0.853, 8.64 % of the modulus at rest.
  const arm::MooneyRivlin hybrid{18.8e3, -14e3};
  const auto last = hybrid.stretch_at(-0.0864 * 28.8e3);
  ASSERT_TRUE(last);
  EXPECT_NEAR(*last, 0.853, 0.01);
  EXPECT_GT(hybrid.tangent_modulus_pa(*last), 0.0);
  EXPECT_FALSE(hybrid.stretch_at(-0.0866 * 28.8e3));
  EXPECT_FALSE(hybrid.stretch_at(-28.8e3));
  // C10 < 0, stretched: at 1.55, 2 (-100 + 193.5) (1.55 - 0.416) = 212 kPa, the modulus is nearly gone.
  const arm::MooneyRivlin necking{-100e3, 300e3};
  EXPECT_TRUE(necking.stretch_at(200e3));
  EXPECT_FALSE(necking.stretch_at(250e3));
  // Far beyond any rubber: 2 * 100 (20 - 1/400) = 4.0 MPa.
  const arm::MooneyRivlin neo_hookean{100e3, 0.0};
  EXPECT_TRUE(neo_hookean.stretch_at(3.5e6));
  EXPECT_FALSE(neo_hookean.stretch_at(5e6));
}

TEST(ArmMooneyRivlin, NothingForWhatIsNoRubber) {
  EXPECT_FALSE((arm::MooneyRivlin{100e3, -100e3}).stretch_at(1.0));
  EXPECT_FALSE((arm::MooneyRivlin{100e3, -200e3}).stretch_at(0.0));
  EXPECT_FALSE((arm::MooneyRivlin{100e3, 0.0}).stretch_at(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE((arm::MooneyRivlin{100e3, 0.0}).stretch_at(std::numeric_limits<double>::infinity()));
}

}  // namespace
}  // namespace softarm
