// What is hidden in the body of the arm, at rest, against closed forms and sums by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../../src/rig/point_loads.h"
#include "rig/hidden_arm.h"

namespace softarm::rig {
namespace {

constexpr double kLength = 0.2, kRodEi = 0.03, kMass = 0.2, kGravity = 9.81;

/// Integral over the arm by the midpoint rule.
double along_arm(const std::function<double(double)>& f) {
  const int n = 200000;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += f((i + 0.5) / n) * kLength / n;
  return sum;
}

/// The tip's angle under a moment of the actuation alone, and under a small force across the tip.
void expect_tip_angles(HiddenArm arm, const std::function<double(double)>& stiffness,
                       const std::function<double(double)>& actuation, double tolerance) {
  const double moment = 0.15, force = 1e-4;
  HiddenArm pushed = arm;
  arm.actuation.moment_nm = {moment, 0.0};
  const double expected =
      along_arm([&](double s) { return moment * actuation(s) / (kRodEi * stiffness(s)); });
  EXPECT_NEAR(tip_angle(arm.settled()) / expected, 1.0, tolerance);
  pushed.inputs.tip_force_base_n = {force, 0.0, 0.0};
  const double pushed_angle =
      along_arm([&](double s) { return force * kLength * (1.0 - s) / (kRodEi * stiffness(s)); });
  EXPECT_NEAR(tip_angle(pushed.settled()) / pushed_angle, 1.0, tolerance);
}

double one(double) {
  return 1.0;
}

TEST(HiddenBody, TapersOfStiffnessAndActuation) {
  HiddenArm arm;
  arm.scenario.body.stiffness_taper = 0.3;
  expect_tip_angles(
      arm, [](double s) { return 1.0 + 0.3 * (2.0 * s - 1.0); }, one, 2e-6);
  arm = HiddenArm();
  arm.scenario.body.actuation_taper = -0.2;
  expect_tip_angles(
      arm, one, [](double s) { return 1.0 - 0.2 * (2.0 * s - 1.0); }, 1e-7);
}

TEST(HiddenBody, StepsOfStiffnessAndActuation) {
  const auto step = [](double s) { return s < 0.5 ? -1.0 : 1.0; };
  HiddenArm arm;
  arm.scenario.body.stiffness_taper = 0.3;
  arm.scenario.body.stiffness_steps = true;
  expect_tip_angles(
      arm, [&](double s) { return 1.0 + 0.3 * step(s); }, one, 2e-6);
  arm = HiddenArm();
  arm.scenario.body.actuation_taper = -0.2;
  arm.scenario.body.actuation_steps = true;
  expect_tip_angles(
      arm, one, [&](double s) { return 1.0 - 0.2 * step(s); }, 1e-6);
  arm.actuation.moment_nm = {0.15, 0.0};
  const RitzRod rod = arm.settled();
  EXPECT_NEAR(rod.curvature(0.49).y(), 1.2 * 0.15 / kRodEi, 1e-6);
  EXPECT_NEAR(rod.curvature(0.51).y(), 0.8 * 0.15 / kRodEi, 1e-6);
}

TEST(HiddenBody, SoftSpotBendsMoreWhereItIs) {
  HiddenArm arm;
  arm.scenario.body.soft_spot = SoftSpot{0.45, 0.15, 0.4};
  const auto ratio = [](double s) {
    const double edge = std::min(std::abs(s - 0.375), std::abs(s - 0.525)) / (0.25 * 0.15);
    if (s < 0.375 || s > 0.525) return 1.0;
    return edge > 1.0 ? 0.6 : 1.0 - 0.4 * (10.0 - 15.0 * edge + 6.0 * edge * edge) * edge * edge * edge;
  };
  expect_tip_angles(arm, ratio, one, 1e-4);
  arm.actuation.moment_nm = {0.15, 0.0};
  const RitzRod rod = arm.settled();
  EXPECT_NEAR(rod.curvature(0.2).y(), 0.15 / kRodEi, 1e-6);
  EXPECT_NEAR(rod.curvature(0.45).y(), 0.15 / (0.6 * kRodEi), 0.1);
  // Finer splines say the same: 0.02 mm are allowed.
  arm.scenario.numerics.elements = 60;
  const Eigen::Vector3d difference = arm.settled().pose(1.0).translation() - rod.pose(1.0).translation();
  EXPECT_LT(difference.norm(), 5e-6);
}

TEST(HiddenBody, ABellIsSoftestAtItsCentre) {
  HiddenArm arm;
  arm.scenario.body.soft_spot = SoftSpot{0.45, 0.15, 0.4, true};
  const auto ratio = [](double s) {
    const double d = std::abs(s - 0.45) / 0.15;
    return d < 0.5 ? 1.0 - 0.4 * 0.5 * (1.0 + std::cos(2.0 * M_PI * d)) : 1.0;
  };
  expect_tip_angles(arm, ratio, one, 1e-4);
  arm.actuation.moment_nm = {0.15, 0.0};
  const RitzRod rod = arm.settled();
  EXPECT_NEAR(rod.curvature(0.2).y(), 0.15 / kRodEi, 1e-6);
  EXPECT_NEAR(rod.curvature(0.45).y(), 0.15 / (0.6 * kRodEi), 0.1);
  EXPECT_NEAR(rod.curvature(0.4125).y(), 0.15 / (0.8 * kRodEi), 0.1) << "half of it, half way to the edge";
}

TEST(HiddenBody, EndCapsStayStraight) {
  HiddenArm arm;
  arm.scenario.body.rigid_ends = RigidEnds{0.015, 0.01};
  arm.actuation.moment_nm = {0.15, 0.0};
  const RitzRod rod = arm.settled();
  EXPECT_NEAR(tip_angle(rod), 0.15 / kRodEi * (kLength - 0.025), 1e-7);
  const Eigen::Isometry3d start = rod.pose(0.015 / kLength);
  EXPECT_LT((start.translation() - Eigen::Vector3d(0.0, 0.0, 0.015)).norm(), 1e-9);
  EXPECT_LT(rod.pose(0.95).linear().col(2).cross(rod.pose(1.0).linear().col(2)).norm(), 1e-8);
}

/// The moment at the base of a horizontal arm that hardly bends, felt by a yielding base.
double moment_at_base(HiddenArm arm) {
  constexpr double kBase = 1e4;
  arm.mount_horizontally();
  arm.actuation.bending_stiffness_nm2 = arm.actuation.torsional_stiffness_nm2 = 1e4;
  arm.scenario.body.base_stiffness_nm_per_rad = kBase;
  return kBase * arm.settled().base_rotation().y();
}

TEST(HiddenBody, WeightIsWhereItIsHidden) {
  const double even = kMass * kGravity * kLength / 2.0;
  EXPECT_NEAR(moment_at_base(HiddenArm()), even, 1e-4 * even);
  HiddenArm taper;
  taper.scenario.body.mass_taper = 0.3;
  EXPECT_NEAR(moment_at_base(taper), even * (1.0 + 0.3 / 3.0), 1e-4 * even);
  HiddenArm lump;
  lump.scenario.body.mass_lump = MassLump{0.25, 0.83};
  EXPECT_NEAR(moment_at_base(lump), even * (0.75 + 2.0 * 0.25 * 0.83), 1e-4 * even);
  // The same with the taper cut into pieces.
  taper.scenario.payload.fraction = 0.37;
  EXPECT_NEAR(moment_at_base(taper), even * (1.0 + 0.3 / 3.0), 1e-4 * even);
  HiddenArm fitting;
  fitting.scenario.body.tip_mass_kg = 0.015;
  EXPECT_NEAR(moment_at_base(fitting), even + 0.015 * kGravity * kLength, 1e-4 * even);
}

TEST(HiddenBody, PayloadOffTheAxis) {
  const double even = kMass * kGravity * kLength / 2.0;
  HiddenArm arm;
  arm.inputs.payload_kg = 0.3;
  arm.scenario.body.payload_offset_m = {0.0, 0.0, 0.02};
  EXPECT_NEAR(moment_at_base(arm), even + 0.3 * kGravity * (kLength + 0.02), 1e-4 * even);
  // Hanging, 10 mm towards x: it swings below the axis, a couple of 0.3 kg g 10 mm.
  HiddenArm hanging;
  hanging.scenario.mount.q_mocap_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  hanging.scenario.gravity_m_s2 = kGravity;
  hanging.inputs.payload_kg = 0.3;
  hanging.scenario.body.payload_offset_m = {0.01, 0.0, 0.0};
  const RitzRod rod = hanging.settled();
  const double tip_moment = 0.3 * kGravity * 0.01 * std::cos(tip_angle(rod));
  EXPECT_GT(tip_moment, 0.02);
  EXPECT_NEAR(-kRodEi * rod.curvature(1.0).y(), tip_moment, 1e-4 * tip_moment);
}

TEST(HiddenBody, TiltOfTheBaseTurnsTheArmAtEveryInput) {
  HiddenArm ideal, tilted;
  tilted.scenario.body.base_tilt_rad = {0.01, -0.015, 0.0};
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(std::hypot(0.01, 0.015), Eigen::Vector3d(0.01, -0.015, 0.0).normalized())
          .toRotationMatrix();
  for (const Eigen::Vector2d& moment : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.2, 0.1)}) {
    ideal.actuation.moment_nm = tilted.actuation.moment_nm = moment;
    const RitzRod straight = ideal.settled(), turned = tilted.settled();
    for (double fraction : {0.0, 0.4, 1.0}) {
      const Eigen::Isometry3d from = straight.pose(fraction), to = turned.pose(fraction);
      EXPECT_LT((to.translation() - tilt * from.translation()).norm(), 1e-12);
      EXPECT_LT((to.linear() - tilt * from.linear()).norm(), 1e-12);
    }
  }
}

TEST(HiddenBody, GravityIsOffTowardsAnAzimuth) {
  HiddenArm arm;
  arm.mount_horizontally();
  arm.scenario.body.gravity_tilt_rad = 0.02 * Eigen::Vector2d(std::cos(0.7), std::sin(0.7));
  const Eigen::Vector3d gravity =
      arm.scenario.mount.q_mocap_base * rod_params(arm.scenario, arm.cut()).gravity_base_m_s2;
  const Eigen::Vector3d expected(std::sin(0.02) * std::cos(0.7), std::sin(0.02) * std::sin(0.7),
                                 -std::cos(0.02));
  EXPECT_LT((gravity - kGravity * expected).norm(), 1e-12);
}

TEST(HiddenBody, BaseTurnsFreelyWithinItsPlay) {
  HiddenArm arm;
  arm.scenario.body.base_play_rad = 0.01;
  arm.scenario.body.base_stiffness_nm_per_rad = 20.0;
  arm.actuation.bending_stiffness_nm2 = 1e4;
  arm.inputs.tip_force_base_n = {1.0, 0.0, 0.0};
  // 1 % of the stiffness from the start, all of it beyond the play and half of its onset of 1 mrad.
  const double turn = (1.0 * kLength + 20.0 * 0.0105) / (20.0 * 1.01);
  EXPECT_NEAR(arm.settled().base_rotation().y(), turn, 1e-5);
  arm.inputs.tip_force_base_n = {-0.005, 0.0, 0.0};
  EXPECT_NEAR(arm.settled().base_rotation().y(), -0.005 * kLength / 0.2, 1e-5);
}

TEST(HiddenBody, ABushGivesWayAsHertzHasIt) {
  HiddenArm arm;
  arm.scenario.body.base_play_rad = 0.01;
  arm.scenario.body.base_bush = true;
  arm.scenario.body.base_stiffness_nm_per_rad = 20.0;
  arm.actuation.bending_stiffness_nm2 = 1e4;
  for (const double force_n : {0.5, -1.0}) {
    arm.inputs.tip_force_base_n = {force_n, 0.0, 0.0};
    const double turn = std::abs(arm.settled().base_rotation().y()), beyond = turn - 0.01;
    EXPECT_GT(beyond, 0.0);
    EXPECT_NEAR(20.0 * (0.001 * turn + std::pow(beyond, 1.5) / std::sqrt(0.001)), std::abs(force_n) * kLength,
                2e-4);
  }
  // Within the play next to nothing holds it.
  arm.inputs.tip_force_base_n = {5e-4, 0.0, 0.0};
  EXPECT_NEAR(arm.settled().base_rotation().y(), 5e-4 * kLength / 0.02, 1e-5);
}

TEST(HiddenBody, TetherPullsTheTipBack) {
  HiddenArm arm;
  arm.scenario.body.tether = Tether{40.0, 0.0, 0.0, false, 0.0, 0.0};
  arm.inputs.tip_force_base_n = {0.01, 0.0, 0.0};
  const double beam = 3.0 * kRodEi / std::pow(kLength, 3);
  EXPECT_NEAR(arm.settled().pose(1.0).translation().x() / (0.01 / (beam + 40.0)), 1.0, 1e-4);
  // A hose with 1 mm of slack, anchored 0.1 m across: silent, then taut; the onset is over 2 mm.
  arm.scenario.body.tether = Tether{40.0, M_PI, 0.1, true, 0.001, 0.0};
  EXPECT_NEAR(arm.settled().pose(1.0).translation().x() / (0.01 / beam), 1.0, 1e-4);
  arm.inputs.tip_force_base_n = {0.2, 0.0, 0.0};
  const double taut = (0.2 + 40.0 * (0.001 + 0.001)) / (beam + 40.0);
  EXPECT_NEAR(arm.settled().pose(1.0).translation().x() / taut, 1.0, 0.01);
  // Its weight: half of it is a dead load at the tip.
  arm = HiddenArm();
  arm.mount_horizontally();
  HiddenArm loaded = arm;
  arm.scenario.body.tether = Tether{40.0, 0.0, 10.0, true, 10.0, 0.03};
  loaded.inputs.tip_force_base_n = {0.015 * kGravity, 0.0, 0.0};
  EXPECT_LT((arm.settled().pose(1.0).translation() - loaded.settled().pose(1.0).translation()).norm(), 1e-9);
}

TEST(HiddenBody, WallHoldsOnePlaceOfTheArm) {
  HiddenArm arm;
  Wall wall;
  wall.stiffness_n_per_m = 50.0;
  wall.distance_m = 0.0004;
  wall.fraction = 0.7;
  arm.scenario.body.wall = wall;
  arm.inputs.tip_force_base_n = {0.02, 0.0, 0.0};
  const RitzRod rod = arm.settled();
  const double s = 0.14, penetration = rod.pose(0.7).translation().x() - wall.distance_m;
  ASSERT_GT(penetration, 2e-4);
  const double push = 50.0 * (penetration - 1e-4);  // half of the onset
  // Superposed cantilevers: deflection at s by the force at the tip and by the wall's at s.
  const double deflection =
      0.02 * s * s * (3.0 * kLength - s) / (6.0 * kRodEi) - push * s * s * s / (3.0 * kRodEi);
  EXPECT_NEAR(rod.pose(0.7).translation().x() / deflection, 1.0, 1e-4);
  EXPECT_NEAR(kRodEi * rod.curvature(0.0).y(), 0.02 * kLength - push * s, 1e-6);
  wall.distance_m = 0.01;  // out of reach
  HiddenArm out = arm, ideal = arm;
  out.scenario.body.wall = wall;
  ideal.scenario.body.wall.reset();
  EXPECT_LT((out.settled().pose(1.0).translation() - ideal.settled().pose(1.0).translation()).norm(), 1e-9);
}

TEST(HiddenBody, RoughWallCarriesWhatLeansOnIt) {
  HiddenArm arm;
  Wall wall;
  wall.stiffness_n_per_m = 300.0;
  wall.distance_m = 0.01;
  wall.everywhere = true;
  wall.friction = 0.3;
  arm.scenario.body.wall = wall;
  arm.mount_horizontally();
  const RitzRod rod = arm.settled();
  double most = 0.0, push = 0.0;
  const int n = 2000;  // force per length: k / 20 mm p (p / 1 mm)^1/2
  for (int i = 0; i < n; ++i) {
    const double depth = std::max(0.0, rod.pose((i + 0.5) / n).translation().x() - 0.01);
    most = std::max(most, depth);
    push += kLength / n * 15000.0 * depth * std::sqrt(depth / 1e-3);
  }
  EXPECT_GT(most, 1e-4);
  // The cut of the rod at the base carries the rest of the weight: as the curvature's derivative there says.
  const double shear = -kRodEi * (rod.curvature(1e-3).y() - rod.curvature(0.0).y()) / (1e-3 * kLength);
  EXPECT_NEAR(push + shear, kMass * kGravity, 0.03 * kMass * kGravity);
}

TEST(HiddenBody, ForcesFromOutsideHaveTheirStiffnessAndDamping) {
  const Plane plane{Eigen::Vector3d(0.6, 0.0, 0.8), 0.01};
  const Eigen::Vector3d x(0.012, 0.001, 0.006), v(0.02, -0.003, 0.01);
  for (const PointLoadPtr& law :
       {spring_to({0.01, 0.02, 0.2}, 30.0), hose_to({0.1, 0.0, 0.0}, 0.08, 30.0, {0.0, 0.0, 0.2}),
        spring_wall(plane, 50.0), rough_wall({plane, 500.0, 1.5, 0.4}),
        round_post({{0.03, 0.0}, 0.02, 500.0, 0.4, 2.0})}) {
    const PointForce force = law->at(x, v);
    ASSERT_GT(force.force_n.norm(), 1e-3);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d dx = 1e-8 * Eigen::Vector3d::Unit(i), dv = 1e-6 * Eigen::Vector3d::Unit(i);
      EXPECT_LT(
          (force.stiffness_n_per_m.col(i) + (law->at(x + dx, v).force_n - law->at(x - dx, v).force_n) / 2e-8)
              .norm(),
          1e-4);
      EXPECT_LT(
          (force.damping_n_s_per_m.col(i) + (law->at(x, v + dv).force_n - law->at(x, v - dv).force_n) / 2e-6)
              .norm(),
          1e-5);
    }
  }
  // Hunt and Crossley: k p^1.5 (1 + c dp/dt); Coulomb: mu of it against the slip; never a pull.
  const RoughWall rough{{Eigen::Vector3d::UnitX(), 0.01}, 500.0, 1.5, 0.4};
  const double push = 500.0 * 2e-3 * std::sqrt(2.0) * (1.0 + 1.5 * 0.1);
  const Eigen::Vector3d sliding = rough_wall(rough)->at({0.012, 0.0, 0.0}, {0.1, 0.5, 0.0}).force_n;
  EXPECT_NEAR(sliding.x(), -push, 1e-12);
  EXPECT_NEAR(sliding.y(), -0.4 * push, 1e-5);
  EXPECT_EQ(rough_wall(rough)->at({0.012, 0.0, 0.0}, {-5.0, 0.0, 0.0}).force_n.norm(), 0.0);
  EXPECT_EQ(rough_wall(rough)->at({0.009, 0.0, 0.0}, {5.0, 0.0, 0.0}).force_n.norm(), 0.0);
  // A post: away from its axis, half the onset late; along it friction and drag.
  const PointLoadPtr post = round_post({{0.03, 0.0}, 0.02, 500.0, 0.4, 2.0});
  const Eigen::Vector3d held = post->at({0.012, 0.0, 0.1}, {0.0, 0.0, 0.2}).force_n;
  EXPECT_NEAR(held.x(), -500.0 * 1e-3, 1e-12);
  EXPECT_NEAR(held.z(), -500.0 * 1e-3 * (0.4 + 2.0 * 0.2), 2e-5);
  EXPECT_EQ(post->at({0.009, 0.0, 0.1}, {5.0, 0.0, 0.0}).force_n.norm(), 0.0);
}

TEST(HiddenBody, StiffeningOfTheWholeArm) {
  HiddenArm arm;
  arm.scenario.body.stiffening = Stiffening{2e-3, false};
  const double u = 9.0;
  arm.actuation.moment_nm = {kRodEi * u * (1.0 + 2e-3 * u * u), 0.0};
  EXPECT_NEAR(tip_angle(arm.settled()), u * kLength, 1e-9);
  arm.scenario.body.stiffening->gent = true;
  arm.actuation.moment_nm = {kRodEi * u / (1.0 - 2e-3 * u * u), 0.0};
  EXPECT_NEAR(tip_angle(arm.settled()), u * kLength, 1e-9);
}

}  // namespace
}  // namespace softarm::rig
