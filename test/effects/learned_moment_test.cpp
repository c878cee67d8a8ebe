// The moment of a discovered law: its size, its bounds, its memories, its way through an arm file.
#include "effects/learned_moment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "drive_trials.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::effects::testing {
namespace {

/// @param to end of the range, which begins at 0
model::Values learned_values(Regressor of, double x_nm, double to, double scale = 1.0, double other = 0.0) {
  model::Values v = model::Values::Zero(LearnedMoment::kCount);
  v[LearnedMoment::kX] = x_nm;
  v[LearnedMoment::kOf] = static_cast<double>(of);
  v[LearnedMoment::kFirst] = kChamber1 + 1;
  v[LearnedMoment::kSecond] = other;
  v[LearnedMoment::kScale] = scale;
  v[LearnedMoment::kTo] = to;
  return v;
}

model::Instant instant_with(double chamber_1, double chamber_2 = 0.0) {
  model::Instant instant;
  instant.inputs = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm().inputs.scalars.size()));
  instant.inputs[kChamber1] = chamber_1;
  instant.inputs[kChamber1 + 1] = chamber_2;
  instant.dt_s = 0.1;
  return instant;
}

/// What act() adds about y, which bends towards x.
double moment_of(const model::Values& values, const model::Instant& instant,
                 const model::Memory& memory = {}) {
  const model::FineRod fine(arm());
  rod::Rod rod = fine.layout();
  const double before = rod.segments[0].moment_nm.y();
  learned_moment().act(arm(), fine, values, instant, nullptr, memory, rod);
  return rod.segments[0].moment_nm.y() - before;
}

TEST(LearnedMoment, IsWhatItSaysWithinItsRange) {
  EXPECT_NEAR(moment_of(learned_values(Regressor::kInput, 2e-3, 40e3), instant_with(20e3)), 1e-3, 1e-12);
  const double product =
      moment_of(learned_values(Regressor::kProduct, 2e-3, 4e8, 1.0, 2.0), instant_with(10e3, 20e3));
  EXPECT_NEAR(product, 2e-3 * 2e8 / 4e8, 1e-12);
  EXPECT_EQ(moment_of(learned_values(Regressor::kInput, 0.0, 40e3), instant_with(20e3)), 0.0);
}

TEST(LearnedMoment, FadesSmoothlyBeyondItsRange) {
  const model::Values values = learned_values(Regressor::kInput, 2e-3, 40e3);
  double most = 0.0;
  for (double p = -400e3; p < 400e3; p += 500.0) {
    const double now = moment_of(values, instant_with(p)),
                 step = moment_of(values, instant_with(p + 1.0)) - now;
    most = std::max(most, std::abs(now));
    EXPECT_LT(std::abs(step), 2.0 * 2e-3 / 40e3) << p;  // no jump
  }
  EXPECT_GE(most, 2e-3 * (1.0 - 1e-9));
  EXPECT_LT(most, 1.5 * 2e-3);
  for (const double far : {400e3, -400e3, 1e12, 1e300})
    EXPECT_NEAR(moment_of(values, instant_with(far)), 0.0, 1e-12) << far;
}

TEST(LearnedMoment, APlayIsHalfItsWidthBehindWhichWayItGoes) {
  const model::Values values = learned_values(Regressor::kPlay, 2e-3, 4e3, 4e3);
  const model::FineRod fine(arm());
  model::Memory memory;
  const auto follow = [&](double p) {
    const double z = learned_moment().regressor(arm(), fine, values, instant_with(p), memory, 0).x();
    learned_moment().remember(arm(), fine, values, instant_with(p), {}, memory);
    return z;
  };
  EXPECT_EQ(follow(0.0), 0.0);
  EXPECT_NEAR(follow(1e3), 1e3, 1e-9);   // within the play
  EXPECT_NEAR(follow(20e3), 2e3, 1e-9);  // pulled along
  EXPECT_NEAR(follow(19e3), 1e3, 1e-9);
  EXPECT_NEAR(follow(5e3), -2e3, 1e-9);
}

TEST(LearnedMoment, ALagDecaysAsAMaxwellElementDoes) {
  const double time_s = 0.8, step = 30e3;
  const model::Values values = learned_values(Regressor::kLag, 2e-3, 40e3, time_s);
  const model::FineRod fine(arm());
  model::Memory memory;
  learned_moment().remember(arm(), fine, values, instant_with(0.0), {}, memory);
  // Up along a straight line in one instant, then held: (1 - exp(-dt / time)) time / dt of it is left.
  double expected = step * -std::expm1(-0.1 / time_s) * time_s / 0.1;
  for (int k = 0; k < 20; ++k) {
    const double z = learned_moment().regressor(arm(), fine, values, instant_with(step), memory, 0).x();
    EXPECT_NEAR(z, expected, 1e-6 * step) << k;
    learned_moment().remember(arm(), fine, values, instant_with(step), {}, memory);
    expected *= std::exp(-0.1 / time_s);
  }
}

TEST(LearnedMoment, GoesThroughAnArmFileAndIsNotInTheCatalogue) {
  model::Values values = learned_values(Regressor::kPlay, 1.7e-3, 4.2e3, 4e3);
  values[LearnedMoment::kFrom] = -4.1e3;
  const model::Present present{&learned_moment(), values};
  const auto again =
      effects_of(arm(), {entry_of(present), entry_of(present)});  // a law may have several terms
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[1].effect, present.effect);
  EXPECT_EQ(again[1].values, values);
  EXPECT_EQ(find("learned_moment"), &learned_moment());
  for (const auto& effect : catalogue()) EXPECT_NE(effect->info().id, "learned_moment");
}

}  // namespace
}  // namespace softarm::effects::testing
