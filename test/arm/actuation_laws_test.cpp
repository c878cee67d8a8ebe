// The laws of tendons, central chambers and cables against values computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "predicted.h"
#include "softarm/arm/laws.h"

namespace softarm {
namespace {

/// A segment of 85 mm with EA = 68 N: one central chamber, three tendons, one cable. Inputs in that order.
arm::Arm driven_arm() {
  arm::Arm arm;
  arm.inputs.scalars.resize(5);
  const char* const names[] = {"centre", "pull_1", "pull_2", "pull_3", "servo"};
  const arm::InputKind kinds[] = {arm::InputKind::kPressure, arm::InputKind::kTension,
                                  arm::InputKind::kTension, arm::InputKind::kTension, arm::InputKind::kAngle};
  for (std::size_t i = 0; i < 5; ++i) {
    arm.inputs.scalars[i].name = names[i];
    arm.inputs.scalars[i].kind = kinds[i];
  }
  arm::Segment segment;
  segment.length_m = 0.085;
  segment.bending_stiffness.base_nm2 = 6.5e-4;
  segment.axial_stiffness_n = 68.0;
  segment.central_chamber = arm::CentralChamber{"centre", 7e-6};
  segment.tendons = {{"pull_1", 0.0, 0.004}, {"pull_2", 120 * kDeg, 0.004}, {"pull_3", -120 * kDeg, 0.004}};
  segment.cables = {{"servo", 90 * kDeg, 8.0}};
  arm.segments.push_back(segment);
  return arm;
}

TEST(ActuationLaws, NoInputIsRest) {
  const arm::SegmentPrediction rest = predicted(driven_arm(), {0.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(rest.moment_nm.norm(), 0.0);
  EXPECT_EQ(rest.curvature_per_m.norm(), 0.0);
  EXPECT_EQ(rest.actuation_nm().norm(), 0.0);
  EXPECT_DOUBLE_EQ(rest.length_m, 0.085);
  EXPECT_DOUBLE_EQ(rest.bending_stiffness_nm2, 6.5e-4);
  EXPECT_DOUBLE_EQ(rest.modulus_ratio, 1.0);
  EXPECT_EQ(rest.tendon_shear_stiffness_n, 0.0);
  EXPECT_EQ(rest.tendon_torsional_stiffness_nm2, 0.0);
}

TEST(ActuationLaws, OneTendonByHand) {
  const arm::SegmentPrediction bent = predicted(driven_arm(), {0.0, 3.0, 0.0, 0.0, 0.0});
  // 3 N * 4 mm = 12 mN m; 85 mm * 3 / 68 = 3.75 mm shorter; 3 N * (4 mm)^2
  EXPECT_NEAR(bent.moment_nm.x(), 0.012, 1e-15);
  EXPECT_NEAR(bent.moment_nm.y(), 0.0, 1e-15);
  EXPECT_NEAR(bent.length_m, 0.08125, 1e-15);
  EXPECT_NEAR(bent.tendon_shear_stiffness_n, 3.0, 1e-15);
  EXPECT_NEAR(bent.tendon_torsional_stiffness_nm2, 4.8e-5, 1e-18);
  EXPECT_DOUBLE_EQ(bent.bending_stiffness_nm2, 6.5e-4);
}

TEST(ActuationLaws, TwoTendonsByHand) {
  const arm::SegmentPrediction bent = predicted(driven_arm(), {0.0, 1.0, 2.0, 0.0, 0.0});
  // x: 4 (1 - 2/2) = 0, y: 4 * 2 * sqrt(3)/2 = 6.93 mN m
  EXPECT_NEAR(bent.moment_nm.x(), 0.0, 1e-15);
  EXPECT_NEAR(bent.moment_nm.y(), 0.004 * std::sqrt(3.0), 1e-15);
}

TEST(ActuationLaws, EqualTendonsOnlyCompress) {
  const arm::SegmentPrediction pulled = predicted(driven_arm(), {0.0, 2.0, 2.0, 2.0, 0.0});
  EXPECT_NEAR(pulled.moment_nm.norm(), 0.0, 1e-15);
  EXPECT_NEAR(pulled.length_m, 0.085 * (1 - 6.0 / 68), 1e-15);
}

TEST(ActuationLaws, TendonOnTheAxisDoesNotBend) {
  arm::Arm arm = driven_arm();
  arm.segments[0].tendons[0].offset_m = 0.0;
  const arm::SegmentPrediction pulled = predicted(arm, {0.0, 3.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(pulled.moment_nm.norm(), 0.0);
  EXPECT_EQ(pulled.tendon_torsional_stiffness_nm2, 0.0);
  EXPECT_NEAR(pulled.length_m, 0.08125, 1e-15);
}

TEST(ActuationLaws, NegativeTensionIsSlack) {
  const arm::Arm arm = driven_arm();
  const arm::SegmentPrediction slack = predicted(arm, {0.0, -5.0, 0.0, 2.0, 0.0});
  const arm::SegmentPrediction zero = predicted(arm, {0.0, 0.0, 0.0, 2.0, 0.0});
  EXPECT_EQ(slack.moment_nm, zero.moment_nm);
  EXPECT_EQ(slack.length_m, zero.length_m);
  EXPECT_EQ(slack.tendon_shear_stiffness_n, 2.0);
}

TEST(ActuationLaws, CentralChamberStretchesByHand) {
  // 40 kPa * 7 mm^2 = 0.28 N over 68 N; with a tendon of 1 N 0.72 N of compression remain
  EXPECT_NEAR(predicted(driven_arm(), {40e3, 0.0, 0.0, 0.0, 0.0}).length_m, 0.085 * (1 + 0.28 / 68), 1e-15);
  EXPECT_NEAR(predicted(driven_arm(), {40e3, 1.0, 0.0, 0.0, 0.0}).length_m, 0.085 * (1 - 0.72 / 68), 1e-15);
  EXPECT_EQ(predicted(driven_arm(), {40e3, 0.0, 0.0, 0.0, 0.0}).moment_nm.norm(), 0.0);
  // Below ambient it pulls together.
  EXPECT_NEAR(predicted(driven_arm(), {-40e3, 0.0, 0.0, 0.0, 0.0}).length_m, 0.085 * (1 - 0.28 / 68), 1e-15);
}

TEST(ActuationLaws, RigidAxisDoesNotStretch) {
  arm::Arm arm = driven_arm();
  arm.segments[0].axial_stiffness_n.reset();
  EXPECT_DOUBLE_EQ(predicted(arm, {40e3, 3.0, 3.0, 0.0, 0.0}).length_m, 0.085);
}

/// C10 = 100 kPa, C01 = 50 kPa: E = 900 kPa; EA = 90 N makes the undeformed wall 1e-4 m^2, so that N newtons
/// are N * 10 kPa of nominal stress.
arm::Arm rubber_arm() {
  arm::Arm arm = driven_arm();
  arm.segments[0].axial_stiffness_n = 90.0;
  arm.segments[0].material = arm::Material{100e3, 50e3};
  arm.segments[0].central_chamber->area_m2 = 1e-4;
  return arm;
}

TEST(ActuationLaws, RubberStretchedByHand) {
  // Stretch 5/4: nominal stress 2 (100 + 50 / 1.25) (1.25 - 0.64) = 170.8 kPa, that is 17.08 N or 170.8 kPa
  // over 1e-4 m^2; tangent modulus 2 * 100 (1 + 2 * 0.512) + 6 * 50 * 0.4096 = 527.68 kPa of 900.
  const arm::SegmentPrediction stretched = predicted(rubber_arm(), {170.8e3, 0.0, 0.0, 0.0, 0.0});
  EXPECT_NEAR(stretched.length_m, 0.085 * 1.25, 1e-12);
  EXPECT_NEAR(stretched.modulus_ratio, 527.68 / 900, 1e-12);
  EXPECT_NEAR(stretched.bending_stiffness_nm2, 6.5e-4 * 527.68 / 900, 1e-15);
}

TEST(ActuationLaws, RubberCompressedByHand) {
  // Stretch 4/5: 2 (100 + 62.5) (0.8 - 1.5625) = -247.8125 kPa, that is 24.78125 N of tendons; tangent
  // modulus 200 (1 + 2 / 0.512) + 300 / 0.4096 = 1713.671875 kPa.
  const double third_n = 24.78125 / 3;
  const arm::SegmentPrediction pressed = predicted(rubber_arm(), {0.0, third_n, third_n, third_n, 0.0});
  EXPECT_NEAR(pressed.length_m, 0.085 * 0.8, 1e-12);
  EXPECT_NEAR(pressed.modulus_ratio, 1713.671875 / 900, 1e-12);
}

TEST(ActuationLaws, SmallLoadsMakeRubberLinear) {
  arm::Arm linear = rubber_arm();
  linear.segments[0].material.reset();
  const arm::InputValues little{100.0, 0.0, 0.0, 0.0, 0.0};  // 0.01 N: a strain of 1.1e-4
  const double strain = 0.01 / 90;
  EXPECT_NEAR(predicted(linear, little).length_m, 0.085 * (1 + strain), 1e-15);
  EXPECT_NEAR(predicted(rubber_arm(), little).length_m, 0.085 * (1 + strain), 0.085 * 3 * strain * strain);
}

TEST(ActuationLaws, UnstableRubberIsNoPrediction) {
  arm::Arm arm = driven_arm();
  arm.segments[0].material = arm::Material{18.8e3, -14e3};  // of the hybrid paper: 8.64 % of 68 N is 5.88 N
  EXPECT_TRUE(arm::predict_segment(arm, arm.segments[0], {0.0, 2.9, 2.9, 0.0, 0.0}));
  EXPECT_FALSE(arm::predict_segment(arm, arm.segments[0], {0.0, 3.0, 3.0, 0.0, 0.0}));
  arm.segments[0].material.reset();
  EXPECT_TRUE(arm::predict_segment(arm, arm.segments[0], {0.0, 3.0, 3.0, 0.0, 0.0}));
  EXPECT_FALSE(arm::predict_segment(arm, arm.segments[0], {0.0, 68.0, 0.0, 0.0, 0.0}));  // no length remains
}

TEST(ActuationLaws, StiffnessByPressure) {
  arm::Arm arm = driven_arm();
  arm.segments[0].bending_stiffness.by_pressure = {{0.0, 6.5e-4}, {10e3, 7e-4}, {40e3, 10e-4}};
  const auto at = [&arm](double pressure_pa) {
    return predicted(arm, {pressure_pa, 0.0, 0.0, 0.0, 0.0}).bending_stiffness_nm2;
  };
  EXPECT_NEAR(at(0.0), 6.5e-4, 1e-18);
  EXPECT_NEAR(at(5e3), 6.75e-4, 1e-18);
  EXPECT_NEAR(at(10e3), 7e-4, 1e-18);
  EXPECT_NEAR(at(25e3), 8.5e-4, 1e-18);
  EXPECT_NEAR(at(40e3), 10e-4, 1e-18);
  EXPECT_NEAR(at(60e3), 10e-4, 1e-18);
  EXPECT_NEAR(at(-5e3), 6.5e-4, 1e-18);
  // It stands for the material's stiffening too, but not for that of the other stiffnesses.
  arm.segments[0].material = arm::Material{100e3, 50e3};
  EXPECT_NEAR(at(25e3), 8.5e-4, 1e-18);
  EXPECT_LT(predicted(arm, {25e3, 0.0, 0.0, 0.0, 0.0}).modulus_ratio, 1.0);
}

TEST(ActuationLaws, CableByHand) {
  // 8 1/(m rad) * 0.5 rad = 4 1/m towards y; as a moment 4 * 6.5e-4
  const arm::SegmentPrediction wound = predicted(driven_arm(), {0.0, 0.0, 0.0, 0.0, 0.5});
  EXPECT_NEAR((wound.curvature_per_m - Eigen::Vector2d(0.0, 4.0)).norm(), 0.0, 1e-14);
  EXPECT_NEAR((wound.actuation_nm() - Eigen::Vector2d(0.0, 2.6e-3)).norm(), 0.0, 1e-15);
  EXPECT_EQ(wound.moment_nm.norm(), 0.0);
  EXPECT_DOUBLE_EQ(wound.length_m, 0.085);
  // Wound off it bends the other way: the servo's other cable.
  EXPECT_NEAR(predicted(driven_arm(), {0.0, 0.0, 0.0, 0.0, -0.5}).curvature_per_m.y(), -4.0, 1e-14);
}

TEST(ActuationLaws, OppositeCablesCancel) {
  arm::Arm arm = driven_arm();
  arm.segments[0].cables.push_back({"servo", -90 * kDeg, 8.0});
  EXPECT_NEAR(predicted(arm, {0.0, 0.0, 0.0, 0.0, 0.5}).curvature_per_m.norm(), 0.0, 1e-14);
}

TEST(ActuationLaws, ActuatorsAddUp) {
  arm::Arm arm = driven_arm();
  arm.segments[0].chambers = {{"centre", 180 * kDeg, 1e-7, 1e-9, 0.0}};
  // Chamber: 40 kPa * 1e-7 = 4 mN m towards -x and 40 um; tendon: 12 mN m towards x, 0.28 - 3 N over 68 N.
  const arm::SegmentPrediction all = predicted(arm, {40e3, 3.0, 0.0, 0.0, 0.5});
  EXPECT_NEAR(all.moment_nm.x(), 0.008, 1e-15);
  EXPECT_NEAR(all.length_m, (0.085 + 40e-6) * (1 - 2.72 / 68), 1e-15);
  EXPECT_NEAR((all.actuation_nm() - Eigen::Vector2d(0.008, 2.6e-3)).norm(), 0.0, 1e-15);
}

TEST(ActuationLaws, TurningTheActuatorsTurnsTheActuation) {
  arm::Arm arm = driven_arm();
  const arm::InputValues inputs{10e3, 3.0, 1.0, 0.5, 0.7};
  const arm::SegmentPrediction original = predicted(arm, inputs);
  ASSERT_GT(original.moment_nm.norm(), 0.005);
  for (arm::Tendon& tendon : arm.segments[0].tendons) tendon.bending_direction_rad += 0.7;
  for (arm::Cable& cable : arm.segments[0].cables) cable.bending_direction_rad += 0.7;
  const arm::SegmentPrediction turned = predicted(arm, inputs);
  const Eigen::Rotation2Dd turn(0.7);
  EXPECT_NEAR((turned.moment_nm - turn * original.moment_nm).norm(), 0.0, 1e-15);
  EXPECT_NEAR((turned.curvature_per_m - turn * original.curvature_per_m).norm(), 0.0, 1e-14);
  EXPECT_EQ(turned.length_m, original.length_m);
  EXPECT_EQ(turned.bending_stiffness_nm2, original.bending_stiffness_nm2);
}

TEST(ActuationLaws, EachAbsentInputGivesNothing) {
  const arm::Arm arm = driven_arm();
  const arm::InputValues all{10e3, 1.0, 1.0, 1.0, 0.5};
  ASSERT_TRUE(arm::predict_segment(arm, arm.segments[0], all));
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const std::optional<double> bad :
         {std::optional<double>(), std::optional<double>(std::numeric_limits<double>::infinity())}) {
      arm::InputValues some = all;
      some[i] = bad;
      EXPECT_FALSE(arm::predict_segment(arm, arm.segments[0], some)) << i;
    }
  }
}

TEST(ActuationLaws, WhatMakesTheStiffnessDependOnInputs) {
  arm::Arm arm = driven_arm();
  arm::Segment& segment = arm.segments[0];
  EXPECT_FALSE(arm::stiffness_depends_on_inputs(segment));
  segment.material = arm::Material{100e3, 50e3};
  EXPECT_TRUE(arm::stiffness_depends_on_inputs(segment));
  segment.axial_stiffness_n.reset();  // what does not stretch does not stiffen
  EXPECT_FALSE(arm::stiffness_depends_on_inputs(segment));
  segment.bending_stiffness.by_pressure = {{0.0, 6.5e-4}};
  EXPECT_TRUE(arm::stiffness_depends_on_inputs(segment));
}

TEST(ActuationLaws, SegmentsTakeTheirOwnInputs) {
  arm::Arm arm = driven_arm();
  arm::Segment distal = arm.segments[0];
  distal.central_chamber.reset();
  distal.cables.clear();
  distal.tendons = {{"pull_3", 45 * kDeg, 0.01}};
  arm.segments.push_back(distal);
  const auto both = predict(arm, {0.0, 3.0, 0.0, 1.0, 0.0});
  ASSERT_TRUE(both);
  ASSERT_EQ(both->size(), 2u);
  // Proximal: 12 - 4/2, -4 sin 60 deg mN m; distal: 10 mN m at 45 deg.
  EXPECT_NEAR((both->at(0).moment_nm - Eigen::Vector2d(0.010, -0.002 * std::sqrt(3.0))).norm(), 0.0, 1e-15);
  EXPECT_NEAR((both->at(1).moment_nm - Eigen::Vector2d(0.01, 0.01) / std::sqrt(2.0)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(predict(arm, {0.0, 3.0, 0.0, std::nullopt, 0.0}));
}

}  // namespace
}  // namespace softarm
