// What is hidden in the body and not in the catalogue: air that moves, a wall that kinks, a coupling that
// plays; against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "../../src/rig/draught.h"
#include "../../src/rig/stretch_laws.h"
#include "rig/hidden_arm.h"
#include "rig/scenario_text.h"
#include "rig/simulator.h"

namespace softarm::rig {
namespace {

constexpr double kArmLength = 0.2, kArmEi = 0.03;

double tip_x(const HiddenArm& arm) {
  return arm.settled().pose(1.0).translation().x();
}

TEST(Draught, BendsACantileverAsAForcePerLengthDoes) {
  HiddenArm arm;
  const double q = 0.01, whole = q * std::pow(kArmLength, 4) / kArmEi;
  arm.inputs.draught_base_n_per_m = {q, 0.0, 0.0};
  EXPECT_NEAR(tip_x(arm) / (whole / 8.0), 1.0, 1e-5);
  arm.scenario.body.draught = Draught{1.0, 1.0, true};
  EXPECT_NEAR(tip_x(arm) / (whole * 11.0 / 120.0), 1.0, 1e-5);
  // The same in pieces; along the arm it does nothing.
  arm.scenario.payload.fraction = 0.37;
  EXPECT_NEAR(tip_x(arm) / (whole * 11.0 / 120.0), 1.0, 1e-5);
  arm.inputs.draught_base_n_per_m = {0.0, 0.0, q};
  EXPECT_EQ(tip_x(arm), 0.0);
}

TEST(Draught, AcrossABentArmItTurnsWithTheArm) {
  // A stiff arm that its actuation bends by a right angle: the part of the force along each section is left
  // out, so that the base feels the moments of q sin(theta) across along the arc of radius R = 2 L / pi.
  HiddenArm arm;
  arm.scenario.body.base_stiffness_nm_per_rad = 1e4;
  arm.actuation.bending_stiffness_nm2 = arm.actuation.torsional_stiffness_nm2 = 1e4;
  arm.actuation.moment_nm = {1e4 * 0.5 * M_PI / kArmLength, 0.0};
  const double q = 0.01;
  arm.inputs.draught_base_n_per_m = {0.0, 0.0, q};
  double moment = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double theta = 0.5 * M_PI * (i + 0.5) / n, radius = 2.0 * kArmLength / M_PI;
    const double x = radius * (1.0 - std::cos(theta)), z = radius * std::sin(theta);
    const double across = -q * std::sin(theta);  // along (cos, -sin), in the plane of x and z
    moment += kArmLength / n * (z * across * std::cos(theta) + x * across * std::sin(theta));
  }
  EXPECT_NEAR(1e4 * arm.settled().base_rotation().y() / moment, 1.0, 1e-4);
}

TEST(Draught, HasItsSizeAndItsCorrelationTime) {
  const double force = 0.02, time_s = 2.0, seconds = 4000.0, dt = 0.5;
  const std::array<double, 3> lags{1.0, 2.0, 4.0};
  for (const bool sheltered : {false, true}) {
    const double per_length = force / ((sheltered ? 11.0 / 40.0 : 3.0 / 8.0) * kArmLength);
    double square = 0.0, vertical = 0.0;
    std::array<double, 3> together{};
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const DraughtForce air(Draught{force, time_s, sheltered}, kArmLength, seed);
      for (double t = 0.0; t < seconds; t += 5.0 * dt, ++count) {
        const Eigen::Vector3d now = air.at(t);
        square += now.squaredNorm();
        vertical = std::max(vertical, std::abs(now.z()));
        for (std::size_t i = 0; i < lags.size(); ++i) together[i] += now.dot(air.at(t + lags[i]));
      }
    }
    EXPECT_NEAR(std::sqrt(square / count) / per_length, 1.0, 0.01);
    EXPECT_EQ(vertical, 0.0);
    for (std::size_t i = 0; i < lags.size(); ++i)
      EXPECT_NEAR(together[i] / square, std::exp(-lags[i] / time_s), 0.04) << lags[i];
  }
}

TEST(Draught, FollowsFromTheSeedAndIsSmooth) {
  const Draught draught{0.02, 2.0, false};
  const DraughtForce one(draught, kArmLength, 7), again(draught, kArmLength, 7),
      other(draught, kArmLength, 8);
  double most = 0.0;
  for (double t = 0.0; t < 60.0; t += 0.01) {
    EXPECT_EQ((one.at(t) - again.at(t)).norm(), 0.0);
    most = std::max(most, (one.at(t) - other.at(t)).norm());
    // No wave is faster than some 20 over the correlation time.
    EXPECT_LT((one.at(t + 0.01) - one.at(t)).norm(), 0.01 * 11.0 * 0.02 / (0.375 * kArmLength) * 2.0);
  }
  EXPECT_GT(most, 0.02);
  EXPECT_EQ(DraughtForce(std::nullopt, kArmLength, 7).at(3.0).norm(), 0.0);
}

/// The tips of a scenario, in the mocap frame.
std::vector<Eigen::Vector3d> mocap_tips(const std::string& hidden, const std::string& attitude,
                                        const std::string& seed = "5") {
  std::string text = kScenarioText;
  const auto replace = [&text](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace("seed: 18446744073709551615", "seed: " + seed);
  replace("duration_s: 10", "duration_s: 6");
  replace("base_nm2: 0.027", "base_nm2: 10");
  replace("attitude: hanging", "attitude: " + attitude);
  Simulator simulator(parse_scenario(text + hidden, "case.yaml"));
  std::vector<Eigen::Vector3d> result;
  while (const auto sample = simulator.next())
    result.push_back(simulator.scenario().mount.q_mocap_base * sample->truth.tip_base.p);
  return result;
}

TEST(Draught, IsHorizontalInTheWorldHoweverTheArmIsMounted) {
  const std::string hidden = "hidden: [{effect: draught, force_n: 2, correlation_s: 1}]\n";
  for (const char* attitude : {"hanging", "horizontal", "standing"}) {
    const std::vector<Eigen::Vector3d> ideal = mocap_tips("", attitude), blown = mocap_tips(hidden, attitude);
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < ideal.size(); ++i) most = most.cwiseMax((blown[i] - ideal[i]).cwiseAbs());
    // Across a stiff horizontal arm, whose base points along x, there is but one horizontal direction.
    EXPECT_GT(most.y(), 2e-4) << attitude;
    if (std::string(attitude) == "horizontal") {
      EXPECT_LT(most.x(), 0.1 * most.y());
    } else {
      EXPECT_GT(most.x(), 1e-4) << attitude;
    }
    EXPECT_LT(most.z(), 0.05 * most.y()) << attitude;
  }
  EXPECT_EQ(mocap_tips(hidden, "hanging", "5"), mocap_tips(hidden, "hanging", "5"));
  EXPECT_NE(mocap_tips(hidden, "hanging", "5"), mocap_tips(hidden, "hanging", "6"));
}

/// A twentieth of the arm folds at 5 / m to half of its stiffness, and opens below 3 / m.
HiddenArm kinking_arm() {
  HiddenArm arm;
  arm.scenario.body.kink = Kink{{0.4, 0.45}, 0.5, 5.0, 3.0};
  return arm;
}

TEST(KinkingArm, AtRestItFoldsWhereTheMomentIsThatOfTheFold) {
  HiddenArm arm = kinking_arm();
  arm.actuation.moment_nm = {kArmEi * 4.99, 0.0};
  EXPECT_NEAR(tip_angle(arm.settled()), 4.99 * kArmLength, 1e-9);
  arm.actuation.moment_nm = {kArmEi * 5.01, 0.0};
  EXPECT_NEAR(tip_angle(arm.settled()), 5.01 * (0.95 * kArmLength + 0.05 * kArmLength / 0.5), 1e-9);
  // To the other side, and by a force across the tip, whose moment there is F L (1 - s).
  arm.actuation.moment_nm = {-kArmEi * 5.01, 0.0};
  EXPECT_NEAR(tip_angle(arm.settled()), -5.01 * (0.95 * kArmLength + 0.05 * kArmLength / 0.5), 1e-9);
  arm.actuation.moment_nm.setZero();
  const auto bends = [&arm](double force_n) {
    arm.inputs.tip_force_base_n = {force_n, 0.0, 0.0};
    HiddenArm ideal = arm;
    ideal.scenario.body.kink.reset();
    return tip_x(arm) - tip_x(ideal);
  };
  arm.scenario.body.kink->fold_per_m = 0.1;
  const double folds_n = 0.1 * kArmEi / (kArmLength * (1.0 - 0.425));
  EXPECT_NEAR(bends(0.999 * folds_n), 0.0, 1e-9);
  const double turn = 1.01 * 0.1 * 0.05 * kArmLength;  // EI is halved: as much again
  EXPECT_NEAR(bends(1.01 * folds_n) / (turn * 0.575 * kArmLength), 1.0, 1e-3);
}

TEST(KinkingArm, UnfoldsAtASmallerMoment) {
  HiddenArm arm = kinking_arm();
  arm.scenario.arm.segments[0].retardation_s = 0.2;  // so that it does not swing
  RitzRod rod = arm.settled();
  const double dt = 0.004, rate = 1.5;  // of M / EI, 1 / (m s)
  double bent = 0.0;                    // M / EI
  const auto take_to = [&](double target) {
    while (std::abs(target - bent) > 1e-9) {
      bent += std::clamp(target - bent, -rate * dt, rate * dt);
      arm.actuation.moment_nm = {kArmEi * bent, 0.0};
      ASSERT_TRUE(rod.step(arm.now(), dt)) << bent;
    }
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(rod.step(arm.now(), dt));
  };
  const auto stretch = [&] { return rod.curvature(0.425).y(); };
  for (const auto& [moment, curvature] :
       {std::pair(4.95, 4.95), std::pair(5.05, 10.1), std::pair(6.0, 12.0), std::pair(3.0, 6.0),
        std::pair(1.55, 3.1), std::pair(1.45, 1.45), std::pair(4.9, 4.9), std::pair(-5.05, -10.1)}) {
    take_to(moment);
    EXPECT_NEAR(stretch(), curvature, 2e-3) << moment;
    EXPECT_NEAR(rod.curvature(0.7).y(), moment, 2e-3) << moment;
  }
  // In the plane of the fold alone.
  arm.actuation.moment_nm.y() = kArmEi * 2.0;
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(rod.step(arm.now(), dt));
  EXPECT_NEAR(rod.curvature(0.425).x(), -2.0, 0.02);
  EXPECT_NEAR(stretch(), -10.1, 0.02);
}

TEST(KinkingArm, TheLoopTakesWhatTheFoldDoesNotGiveBack) {
  const SectionLawPtr law = kink_law({{}, 0.5, 5.0, 3.0});
  std::vector<double> memory(law->memory_size(), 0.0), after = memory;
  SectionStep step;
  step.stiffness_nm2 = kArmEi;
  step.dt_s = 1.0;  // long against the folding
  double work = 0.0, moment = 0.0, most = 0.0;
  const double du = 1e-3;
  for (int i = 1; i <= 16000; ++i) {
    step.last_curvature = step.curvature;
    step.curvature.y() = du * (i <= 8000 ? i : 16000 - i);
    SectionResponse response;
    law->add(step, memory.data(), after.data(), response);
    memory = after;
    const double now = kArmEi * step.curvature.y() + response.moment_nm.y();
    work += 0.5 * (now + moment) * (step.curvature - step.last_curvature).y();
    moment = now;
    if (i <= 6000) most = std::max(most, moment);
    ASSERT_GT(work - 0.5 * kArmEi * step.curvature.squaredNorm() - response.stored_j_per_m, -1e-6) << i;
  }
  EXPECT_NEAR(most, kArmEi * 5.0, 1e-3 * kArmEi * 5.0);
  EXPECT_NEAR(work, 0.5 * 0.5 * kArmEi * (25.0 - 9.0), 0.01 * work);
}

/// A coupling at 0.4 of the arm with a degree of play.
constexpr double kPlay = M_PI / 180.0, kCouplingAt = 0.41 * kArmLength, kCouplingLength = 0.02 * kArmLength;

/// How far it turns under a moment more than the stretch that it replaces, by bisection.
double turns_more(double moment_nm) {
  const double k = kArmEi / kCouplingLength, onset = 0.1 * kPlay;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.5 * (low + high), beyond = angle - kPlay;
    const double held = beyond <= 0.0    ? 0.0
                        : beyond < onset ? 0.5 * beyond * beyond / onset
                                         : beyond - 0.5 * onset;
    (k * (0.01 * angle + 0.99 * held) < moment_nm ? low : high) = angle;
  }
  return low - moment_nm / k;
}

TEST(JointPlay, TheTipMovesByTheAngleTimesTheDistanceAndThenIsHeld) {
  HiddenArm arm, ideal;
  arm.scenario.body.joint_play = JointPlay{{0.4, 0.42}, kPlay};
  const double lever = kArmLength - kCouplingAt;
  const auto more = [&](double force_n) {
    arm.inputs.tip_force_base_n = ideal.inputs.tip_force_base_n = {force_n, 0.0, 0.0};
    return tip_x(arm) - tip_x(ideal);
  };
  for (const double force_n : {0.001, 0.005, 0.02, 0.05})
    EXPECT_NEAR(more(force_n) / (turns_more(force_n * lever) * lever), 1.0, 0.01) << force_n;
  EXPECT_NEAR(more(-0.05), -more(0.05), 1e-9);
  // Within the play next to nothing holds it: a hundredth of the stretch's stiffness.
  EXPECT_GT(more(0.01) / (kPlay * lever), 0.8);
  // Beyond it the arm gives way as the ideal one does.
  EXPECT_NEAR(more(0.10), more(0.08), 0.01 * more(0.08));
  EXPECT_NEAR(more(0.10) / (kPlay * lever), 1.05, 0.03) << "half of the onset";
}

TEST(JointPlay, WhatDrivesTheArmDoesNotTurnTheCoupling) {
  HiddenArm arm;
  arm.scenario.body.joint_play = JointPlay{{0.4, 0.42}, kPlay};
  arm.actuation.moment_nm = {0.15, 0.05};
  HiddenArm ideal = arm;
  ideal.scenario.body.joint_play.reset();
  EXPECT_LT((arm.settled().pose(1.0).translation() - ideal.settled().pose(1.0).translation()).norm(), 1e-8);
  // Its weight does: to one stop, and to the other where it stands on its head.
  const auto turn = [](const RitzRod& rod) {
    return Eigen::Vector3d(rod.pose(0.4).linear().col(2)).cross(rod.pose(0.42).linear().col(2)).y();
  };
  for (const double sense : {1.0, -1.0}) {
    for (HiddenArm* one : {&arm, &ideal}) {
      one->mount_horizontally();
      one->scenario.gravity_m_s2 *= sense;
      one->actuation.moment_nm.setZero();
    }
    EXPECT_NEAR(sense * (turn(arm.settled()) - turn(ideal.settled())), 1.05 * kPlay, 0.05 * kPlay) << sense;
  }
}

TEST(JointPlay, TangentIsTheDerivativeAndWhatLagsIsTheMoment) {
  const SectionLawPtr law = joint_play_law(kPlay);
  const std::vector<double> past{0.001, -0.002, 0.003, 0.001, -0.002, 0.002};
  std::vector<double> after(past.size());
  const auto ask = [&](const Eigen::Vector2d& curvature, double dt_s) {
    SectionStep step;
    step.stiffness_nm2 = kArmEi;
    step.length_m = kCouplingLength;
    step.driven_per_m = {0.3, -0.8};
    step.curvature = curvature;
    step.dt_s = dt_s;
    if (dt_s > 0.0) {
      step.lag_slope = 3.0;
      step.lag_per_m = 3.0 * curvature + Eigen::Vector2d(5.0, -3.0);
      step.lag_past = {-4.0, 2.0, -1.0};
    }
    SectionResponse response;
    law->add(step, past.data(), after.data(), response);
    return response;
  };
  for (const Eigen::Vector2d& u :
       {Eigen::Vector2d(1.0, 2.0), Eigen::Vector2d(3.0, 2.6), Eigen::Vector2d(-4.0, 6.0)}) {
    for (const double dt_s : {0.0, 0.01}) {
      Eigen::Matrix2d difference;
      for (int i = 0; i < 2; ++i) {
        const Eigen::Vector2d step = 1e-6 * Eigen::Vector2d::Unit(i);
        difference.col(i) = (ask(u + step, dt_s).moment_nm - ask(u - step, dt_s).moment_nm) / 2e-6;
      }
      EXPECT_LT((ask(u, dt_s).tangent_nm2 - difference).norm(), 1e-6 * kArmEi) << u.transpose();
    }
    const Eigen::Vector2d x = u - Eigen::Vector2d(0.3, -0.8);
    const Eigen::Vector2d held = kArmEi * x + ask(u, 0.0).moment_nm;
    const Eigen::Vector2d lag(-4.0 * 0.001 + 2.0 * 0.003 + 0.002, 4.0 * 0.002 + 2.0 * 0.001 - 0.002);
    EXPECT_LT((ask(u, 0.01).moment_nm - (held - kArmEi * x) - 3.0 * held - lag +
               kArmEi * (3.0 * u + Eigen::Vector2d(5.0, -3.0)))
                  .norm(),
              1e-15)
        << u.transpose();
    EXPECT_EQ(std::vector<double>(after.begin() + 2, after.end()),
              std::vector<double>(past.begin(), past.begin() + 4));
    EXPECT_NEAR(after[0], held.x(), 1e-15);
  }
}

TEST(HiddenStretches, NothingElseCutsThem) {
  HiddenArm arm = kinking_arm();
  arm.scenario.body.soft_spot = SoftSpot{0.425, 0.02, 0.0, true};
  arm.scenario.body.mass_lump = MassLump{0.0, 0.43};
  arm.scenario.body.joint_play = JointPlay{{0.6, 0.62}, kPlay};
  int kinks = 0, couplings = 0;
  for (const Part& part : arm.cut().parts) {
    kinks += part.middle() > 0.4 && part.middle() < 0.45 ? 1 : 0;
    couplings += part.middle() > 0.6 && part.middle() < 0.62 ? 1 : 0;
  }
  EXPECT_EQ(kinks, 1);
  EXPECT_EQ(couplings, 1);
}

TEST(HiddenStretches, WhereTheyDoNotFitALineSaysWhy) {
  const auto says = [](const std::vector<HiddenChoice>& choices, double payload_at) -> std::string {
    HiddenArm arm;
    arm.scenario.arm.segments.resize(2, arm.scenario.arm.segments[0]);
    arm.scenario.payload.fraction = payload_at;
    try {
      for (const HiddenChoice& choice : choices) hide(choice, arm.scenario);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  const auto play = [](double fraction) {
    return HiddenChoice{"joint_play", "", {{"play_deg", 1.0}, {"fraction", fraction}}};
  };
  const auto kink = [](double fraction) {
    return HiddenChoice{"kink", "", {{"share", 0.4}, {"fraction", fraction}, {"fold_per_m", 3.0}}};
  };
  EXPECT_EQ(says({play(0.5), kink(0.3)}, 1.0), "taken");
  EXPECT_THAT(says({play(0.49)}, 1.0), ::testing::HasSubstr("a segment ends at 0.5"));
  EXPECT_THAT(says({kink(0.7)}, 0.72), ::testing::HasSubstr("the payload hangs at 0.72"));
  EXPECT_THAT(says({kink(0.97)}, 1.0), ::testing::HasSubstr("allowed up to 0.95"));
  EXPECT_THAT(says({play(0.3), kink(0.28)}, 1.0), ::testing::HasSubstr("another effect has the stretch 0.3"));
  EXPECT_THAT(says({play(0.3), play(0.6)}, 1.0), ::testing::HasSubstr("twice"));
}

}  // namespace
}  // namespace softarm::rig
