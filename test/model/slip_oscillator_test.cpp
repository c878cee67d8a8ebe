// A swing beside dry friction against small steps of another method, and its energy.
#include "model/slip_oscillator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace softarm {
namespace {

using model::SlipOscillator;
using SlipConstants = SlipOscillator::Constants;
using SlipState = SlipOscillator::State;

/// Velocity Verlet in small steps, the spring stretched and cut off.
SlipState in_small_steps(const SlipConstants& c, SlipState at, double dt_s, int steps) {
  const double h = dt_s / steps;
  const auto acceleration = [&] {
    return -c.stiffness * at.x - c.slip_stiffness * at.z - c.damping * at.rate;
  };
  for (int i = 0; i < steps; ++i) {
    const double half = at.rate + 0.5 * h * acceleration();
    at.x += h * half;
    at.z = std::clamp(at.z + h * half, -c.slip, c.slip);
    at.rate = half;
    at.rate = half + 0.5 * h * acceleration();
  }
  return at;
}

TEST(SlipOscillator, IsThatOfSmallSteps) {
  const SlipConstants constants{69.0, 2.6, 89.0, 0.0106};
  const SlipOscillator oscillator(constants);
  SlipState exact{0.16, 0.0, 0.0106}, fine = exact;
  for (int k = 0; k < 300; ++k) {
    exact = oscillator.step(exact, 0.01);
    fine = in_small_steps(constants, fine, 0.01, 2000);
    ASSERT_NEAR(exact.x, fine.x, 1e-6) << k;
    ASSERT_NEAR(exact.rate, fine.rate, 2e-5) << k;
    ASSERT_NEAR(exact.z, fine.z, 1e-6) << k;
  }
}

TEST(SlipOscillator, DoesNotDependOnTheSteps) {
  const SlipOscillator oscillator({40.0, 0.5, 200.0, 0.004});
  const SlipState start{0.05, 0.3, -0.002};
  SlipState many = start;
  for (int k = 0; k < 1500; ++k) many = oscillator.step(many, 0.001);
  const SlipState one = oscillator.step(start, 1.5);
  EXPECT_NEAR(one.x, many.x, 1e-10);
  EXPECT_NEAR(one.rate, many.rate, 1e-9);
  EXPECT_NEAR(one.z, many.z, 1e-10);
}

TEST(SlipOscillator, LosesWhatSlips) {
  // Without damping the energy that is gone is the force of the slip times the way that it went.
  const SlipConstants c{50.0, 0.0, 120.0, 0.006};
  const SlipOscillator oscillator(c);
  const auto energy = [&](const SlipState& s) {
    return 0.5 * (s.rate * s.rate + c.stiffness * s.x * s.x + c.slip_stiffness * s.z * s.z);
  };
  SlipState at{0.1, 0.0, 0.006};
  const double begin = energy(at);
  double slipped = 0.0;
  for (int k = 0; k < 100000; ++k) {
    const SlipState next = oscillator.step(at, 1e-4);
    slipped += std::abs((next.x - at.x) - (next.z - at.z));
    at = next;
  }
  EXPECT_GT(slipped, 0.1);
  EXPECT_NEAR(begin - energy(at), c.slip_stiffness * c.slip * slipped, 1e-6 * begin);
  EXPECT_GT(energy(at), 0.0) << "it goes on within the slip";
}

TEST(SlipOscillator, SwingsFasterWhenSmall) {
  const SlipConstants c{50.0, 0.0, 120.0, 0.006};
  const double period_s = 2.0 * M_PI / std::sqrt(c.stiffness + c.slip_stiffness);
  const SlipState small = SlipOscillator(c).step({0.003, 0.0, 0.003}, period_s);
  EXPECT_NEAR(small.x, 0.003, 1e-12);
  EXPECT_NEAR(small.rate, 0.0, 1e-10);
  const SlipState linear = SlipOscillator({50.0, 0.0, 0.0, 0.0}).step({0.1, 0.0, 0.0}, 0.3);
  EXPECT_NEAR(linear.x, 0.1 * std::cos(0.3 * std::sqrt(50.0)), 1e-12);
}

}  // namespace
}  // namespace softarm
