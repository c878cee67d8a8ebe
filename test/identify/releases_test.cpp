// Releases of an arm whose frequency, damping and friction are known, integrated in small steps.
#include "identify/releases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "model/rest_modes.h"
#include "synthetic.h"

namespace softarm::identify {
namespace {

struct TrueSwing {
  double stiffness, damping, slip_stiffness, slip_m;
};

/// Held for half a second, let go at once; the outermost body moves by q, the others as the lowest mode has
/// it.
trial::Trial release_by(const arm::Arm& arm, const TrueSwing& s, double held_m, int number) {
  const model::Modes modes = *model::modes_at_no_input(arm, 0.2, 2);
  const auto rows = 3 * static_cast<Eigen::Index>(arm.bodies.size());
  Eigen::VectorXd along = modes.bodies.col(1).head(rows);
  along /= along.tail<3>().norm();
  std::mt19937_64 random(static_cast<std::uint64_t>(number));
  trial::Trial trial{"release_" + std::to_string(number), {}};
  double x = held_m, rate = 0.0, z = std::copysign(s.slip_m, held_m);
  for (int k = 0; k < 450; ++k) {
    trial::Frame frame;
    frame.stamp_ns = 10'000'000LL * k;
    frame.payload_kg = 0.2;
    for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
      const auto row = 3 * static_cast<Eigen::Index>(b);
      const Eigen::Vector3d p = Eigen::Vector3d(0.0, 0.0, arm.bodies[b].arclength_m) +
                                along.segment<3>(row) * x + 1e-4 * testing::normal3(random);
      frame.bodies.push_back({static_cast<int>(b), arm.base.fixed_pose * p, std::nullopt});
    }
    trial.frames.push_back(frame);
    for (int i = 0; i < 200 && k >= 50; ++i) {
      const double h = 5e-5;
      rate += h * (-s.stiffness * x - s.damping * rate - s.slip_stiffness * z);
      x += h * rate;
      z = std::clamp(z + h * rate, -s.slip_m, s.slip_m);
    }
  }
  return trial;
}

std::vector<trial::Trial> four_releases(const arm::Arm& arm, const TrueSwing& swing) {
  return {release_by(arm, swing, 0.12, 1), release_by(arm, swing, -0.15, 2), release_by(arm, swing, -0.08, 3),
          release_by(arm, swing, 0.05, 4)};
}

TEST(Releases, FindFrequencyAndDamping) {
  const arm::Arm arm = testing::shipped("tendon_trunk");
  const double stiffness = std::pow(2.0 * M_PI * 1.6, 2);
  const ReleaseFit fit =
      fit_releases(arm, four_releases(arm, {stiffness, 2.0 * 0.2 * std::sqrt(stiffness), 0.0, 0.0}));
  EXPECT_NEAR(fit.mode_hz[1] * std::sqrt(fit.linear.stiffness_scale), 1.6, 0.02);
  EXPECT_NEAR(fit.linear.damping_ratio, 0.2, 0.01);
  for (const ReleaseError& e : fit.errors) EXPECT_LT(e.linear_m, 0.01 * e.amplitude_m) << e.trial;
}

TEST(Releases, FindFriction) {
  const arm::Arm arm = testing::shipped("tendon_trunk");
  const double stiffness = std::pow(2.0 * M_PI * 1.4, 2);
  const ReleaseFit fit = fit_releases(
      arm, four_releases(arm, {stiffness, 2.0 * 0.1 * std::sqrt(stiffness), 1.2 * stiffness, 0.008}));
  EXPECT_NEAR(fit.mode_hz[1] * std::sqrt(fit.slip.stiffness_scale), 1.4, 0.06);
  EXPECT_NEAR(fit.slip.damping_ratio, 0.1, 0.02);
  EXPECT_NEAR(fit.slip.slip_share * fit.slip.slip_m, 1.2 * 0.008, 0.0015) << "force at which it slips";
  for (const ReleaseError& e : fit.errors) {
    EXPECT_LT(e.slip_m, 0.03 * e.amplitude_m) << e.trial << ": where it comes to rest differs by friction";
    EXPECT_LT(e.slip_m, 0.5 * e.linear_m) << e.trial;
  }
}

TEST(Releases, SayWhatCannotBeUsed) {
  const arm::Arm arm = testing::shipped("tendon_trunk");
  const TrueSwing swing{80.0, 5.0, 0.0, 0.0};
  std::vector<trial::Trial> trials = four_releases(arm, swing);
  trials[1].frames.resize(100);
  trials.push_back({"empty", {}});
  EXPECT_EQ(fit_releases(arm, trials).left_out.size(), 2u);
  trials.erase(trials.begin() + 2, trials.begin() + 4);
  EXPECT_THROW(fit_releases(arm, trials), std::invalid_argument);
}

TEST(Releases, LowestModeIsThatOfACantilever) {
  // 3.516 sqrt(EI / (m L^4)): Blevins, Formulas for natural frequency and mode shape, table 8-1.
  arm::Arm arm = testing::shipped("tendon_trunk");
  arm.gravity_m_s2.setZero();
  arm.tip_mass_kg = 0.0;
  for (arm::Segment& segment : arm.segments) segment.rest_curvature_per_m.setZero();
  const arm::Segment& s = arm.segments[0];
  const double length_m = arm.total_length_m();
  const auto modes = model::modes_at_no_input(arm, 0.0, 2);
  ASSERT_TRUE(modes);
  const double expected =
      3.516 * std::sqrt(s.bending_stiffness.base_nm2 / (s.mass_per_length_kg_m * std::pow(length_m, 4)));
  for (int m = 0; m < 2; ++m) EXPECT_NEAR(std::sqrt(modes->stiffness[m]) / expected, 1.0, 0.02);
}

}  // namespace
}  // namespace softarm::identify
