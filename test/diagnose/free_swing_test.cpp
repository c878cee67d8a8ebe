// How well a swing is known that a hand left, beside a model that is off.
#include "diagnose/free_swing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace softarm::diagnose {
namespace {

using Eigen::Vector3d;

constexpr double kStep_s = 0.2, kOmega = 15.0, kWhite_m = 2e-5, kReach_m = 0.02;

/// One body that swings along x after a hand let go, without damping.
struct Recorded {
  model::TrialData trial;
  std::vector<model::Predicted> predicted;
  model::Modes modes;
  FreeSwing swing;
};

/// @param error of the model, at a time
template <class Error>
Recorded recorded(double swing_m, const Error& error) {
  constexpr int kBlocks = 90;
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0.0, kWhite_m);
  Recorded made;
  made.modes.bodies = Eigen::MatrixXd::Zero(6, 1);
  made.modes.bodies(0, 0) = 1.0;
  made.modes.stiffness = Eigen::VectorXd::Constant(1, kOmega * kOmega);
  made.swing.reach_m = kReach_m;
  for (int k = 0; k < kBlocks; ++k) {
    const double t_s = kStep_s * k;
    Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6, 2);
    by.row(0) << std::cos(kOmega * t_s), std::sin(kOmega * t_s) / kOmega;
    model::Predicted now;
    now.solved = true;
    now.p = Vector3d(0.01, 0.0, 0.12);
    now.rest.t_s = t_s;
    model::Seen seen;
    seen.white_sd_m = kWhite_m;
    seen.p_base = now.p.col(0) + error(t_s) + Vector3d(noise(random), noise(random), noise(random));
    seen.p_base.x() += swing_m * std::cos(kOmega * t_s);
    model::Block block;
    block.bodies = {seen};
    made.trial.blocks.push_back(block);
    made.predicted.push_back(now);
    made.swing.by.push_back(by);
  }
  return made;
}

TEST(KnownSwing, IsKnownToTheNoiseBesideAnErrorThatStays) {
  for (const double swing_m : {0.0, 2e-4}) {
    SCOPED_TRACE(swing_m);
    const Recorded made = recorded(swing_m, [](double t_s) { return Vector3d(0.01, 1e-4 * t_s, -0.004); });
    const KnownSwing known = known_of(made.swing, made.modes, made.trial, made.predicted);
    ASSERT_EQ(known.displacement.size(), made.swing.by.size());
    for (std::size_t k = 0; k < known.displacement.size(); ++k) {
      const double truth_m = swing_m * made.swing.by[k](0, 0);
      // A hundredth of the error; the swing itself counts as what the model misses.
      EXPECT_LT(known.sd_m[k], swing_m > 0.0 ? 2e-4 : 2e-5);
      EXPECT_NEAR(known.displacement[k][0], truth_m, 3.0 * known.sd_m[k]);
    }
  }
}

TEST(KnownSwing, IsNotKnownBesideAnErrorThatMovesAsMuch) {
  const auto steps = [](double t_s) {
    return Vector3d(std::fmod(t_s, 4.0) < 2.0 ? 0.005 : -0.005, 0.0, 0.0);
  };
  const Recorded made = recorded(2e-3, steps);
  const KnownSwing known = known_of(made.swing, made.modes, made.trial, made.predicted);
  ASSERT_EQ(known.sd_m.size(), made.swing.by.size());
  for (std::size_t k = 0; k < known.sd_m.size(); ++k) {
    EXPECT_GT(known.sd_m[k], 2e-4);
    EXPECT_LT(known.sd_m[k], kReach_m);
    EXPECT_NEAR(known.displacement[k][0], 2e-3 * made.swing.by[k](0, 0), 3.0 * known.sd_m[k]);
  }
}

}  // namespace
}  // namespace softarm::diagnose
