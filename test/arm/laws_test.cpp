// The pressure laws against values computed by hand.
#include "softarm/arm/laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "predicted.h"

namespace softarm {
namespace {

/// The semi-physical paper's arm (Table 1), in SI.
arm::Arm table_1_arm() {
  arm::Arm arm;
  arm.inputs.scalars.resize(4);
  const char* const names[] = {"chamber_1", "chamber_2", "chamber_3", "vacuum"};
  for (std::size_t i = 0; i < 4; ++i) arm.inputs.scalars[i].name = names[i];
  arm.inputs.scalars[3].kind = arm::InputKind::kVacuum;
  arm::Segment segment;
  segment.length_m = 0.2;
  segment.bending_stiffness = {0.027, 3e-7, 1.3e-6};
  segment.chambers = {{"chamber_1", 0.0, 6.1e-6, 6.58e-7, 0.0},
                      {"chamber_2", 120 * kDeg, 7.8e-6, 2.75e-7, 1.30e-7},
                      {"chamber_3", -120 * kDeg, 6.5e-6, 1.25e-6, 2.32e-7}};
  segment.jamming_input = "vacuum";
  arm.segments.push_back(segment);
  return arm;
}

double direction(const arm::SegmentPrediction& prediction) {
  return std::atan2(prediction.moment_nm.y(), prediction.moment_nm.x());
}

TEST(Laws, RestIsTheUnloadedArm) {
  const arm::SegmentPrediction rest = predicted(table_1_arm(), {0.0, 0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(rest.length_m, 0.2);
  EXPECT_DOUBLE_EQ(rest.bending_stiffness_nm2, 0.027);
  EXPECT_DOUBLE_EQ(rest.moment_nm.norm(), 0.0);
}

TEST(Laws, LengthByHand) {
  // 200 + 10 (0.658 + 0) + 20 (0.275 + 0.130) + 30 (1.25 + 0.232) = 200 + 6.58 + 8.1 + 44.46 mm
  EXPECT_NEAR(predicted(table_1_arm(), {10e3, 20e3, 30e3, 0.0}).length_m, 0.25914, 1e-12);
}

/// Equations (3)-(6) as printed, with the bending axis searched for and not substituted.
double printed_length_m(const arm::Segment& segment, const std::array<double, 3>& p) {
  const auto& c = segment.chambers;
  const double shift[] = {0.0, 120 * kDeg, -120 * kDeg};  // signs of (3)
  double sine = 0.0;
  double cosine = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double difference = p[i] * (c[i].near_elongation_m_per_pa - c[i].far_elongation_m_per_pa);
    sine += difference * std::sin(shift[i]);
    cosine += difference * std::cos(shift[i]);
  }
  const double alpha = -std::atan2(sine, cosine) + M_PI / 2;  // (5), (6)
  double length = segment.length_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const double sum = c[i].near_elongation_m_per_pa + c[i].far_elongation_m_per_pa;
    const double difference = c[i].near_elongation_m_per_pa - c[i].far_elongation_m_per_pa;
    length += p[i] * (sum + difference * std::cos(alpha + shift[i]));
  }
  return length;
}

TEST(Laws, LengthIsThePrintedOneOnTheBendingAxis) {
  const arm::Arm arm = table_1_arm();
  for (const std::array<double, 3>& p : {std::array<double, 3>{50e3, 0, 0},
                                         {0, 50e3, 0},
                                         {0, 0, 50e3},
                                         {10e3, 20e3, 30e3},
                                         {45e3, 12e3, 33e3},
                                         {50e3, 50e3, 50e3}}) {
    EXPECT_NEAR(predicted(arm, {p[0], p[1], p[2], 0.0}).length_m, printed_length_m(arm.segments[0], p),
                1e-12);
  }
}

TEST(Laws, StiffnessByHand) {
  // 0.027 + 0.0003 * 10 + 0.0013 * (60 + (10 + 20 + 30) / 3) = 0.027 + 0.003 + 0.104
  EXPECT_NEAR(predicted(table_1_arm(), {10e3, 20e3, 30e3, 60e3}).bending_stiffness_nm2, 0.134, 1e-12);
  // One chamber alone has no antagonist: 0.027 + 0.0013 * 50 / 3
  EXPECT_NEAR(predicted(table_1_arm(), {50e3, 0.0, 0.0, 0.0}).bending_stiffness_nm2, 0.027 + 0.065 / 3,
              1e-12);
}

TEST(Laws, MomentByHand) {
  const arm::SegmentPrediction only_1 = predicted(table_1_arm(), {50e3, 0.0, 0.0, 0.0});
  EXPECT_NEAR(only_1.moment_nm.x(), 0.305, 1e-12);
  EXPECT_NEAR(only_1.moment_nm.y(), 0.0, 1e-12);
  // x: 0.061 - (0.156 + 0.195) / 2, y: (0.156 - 0.195) sqrt(3) / 2
  const arm::SegmentPrediction all = predicted(table_1_arm(), {10e3, 20e3, 30e3, 0.0});
  EXPECT_NEAR(all.moment_nm.x(), -0.1145, 1e-12);
  EXPECT_NEAR(all.moment_nm.y(), -0.039 * std::sqrt(3.0) / 2, 1e-12);
}

TEST(Laws, SideChambersPushOppositeWays) {
  const arm::Arm arm = table_1_arm();
  EXPECT_NEAR(direction(predicted(arm, {0.0, 30e3, 0.0, 0.0})), 120 * kDeg, 1e-12);
  EXPECT_NEAR(direction(predicted(arm, {0.0, 0.0, 30e3, 0.0})), -120 * kDeg, 1e-12);

  // Equation (11) as printed: M_y = c_2 sin(2 pi/3) P_2 - c_3 sin(-2 pi/3) P_3. Both side chambers would push
  // to +y, and no combination of pressures could bend the arm to -y.
  const auto printed_my = [&arm](double p2, double p3) {
    const std::vector<arm::Chamber>& c = arm.segments[0].chambers;
    return c[1].moment_gain_nm_per_pa * std::sin(2 * M_PI / 3) * p2 -
           c[2].moment_gain_nm_per_pa * std::sin(-2 * M_PI / 3) * p3;
  };
  EXPECT_GT(printed_my(30e3, 0.0), 0.0);
  EXPECT_GT(printed_my(0.0, 30e3), 0.0);
  EXPECT_LT(predicted(arm, {0.0, 0.0, 30e3, 0.0}).moment_nm.y(), 0.0);
}

TEST(Laws, EqualChambersAreSymmetricUnderRotation) {
  arm::Arm arm = table_1_arm();
  for (arm::Chamber& chamber : arm.segments[0].chambers) {
    chamber.moment_gain_nm_per_pa = 7e-6;
    chamber.near_elongation_m_per_pa = 3e-8;
    chamber.far_elongation_m_per_pa = 1e-8;
  }
  const arm::SegmentPrediction original = predicted(arm, {10e3, 25e3, 40e3, 20e3});
  // Moving every pressure to the next chamber turns the moment by 120 deg and changes nothing else.
  const arm::SegmentPrediction turned = predicted(arm, {40e3, 10e3, 25e3, 20e3});
  const Eigen::Vector2d expected = Eigen::Rotation2Dd(120 * kDeg) * original.moment_nm;
  EXPECT_NEAR((turned.moment_nm - expected).norm(), 0.0, 1e-12);
  EXPECT_GT(original.moment_nm.norm(), 0.1);
  EXPECT_DOUBLE_EQ(turned.length_m, original.length_m);
  EXPECT_DOUBLE_EQ(turned.bending_stiffness_nm2, original.bending_stiffness_nm2);
  // Equal pressures do not bend.
  EXPECT_NEAR(predicted(arm, {30e3, 30e3, 30e3, 0.0}).moment_nm.norm(), 0.0, 1e-12);
}

TEST(Laws, TurningTheChambersTurnsTheMoment) {
  arm::Arm arm = table_1_arm();
  const arm::InputValues inputs{10e3, 25e3, 40e3, 0.0};
  const arm::SegmentPrediction original = predicted(arm, inputs);
  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.bending_direction_rad += 0.7;
  const Eigen::Vector2d expected = Eigen::Rotation2Dd(0.7) * original.moment_nm;
  EXPECT_NEAR((predicted(arm, inputs).moment_nm - expected).norm(), 0.0, 1e-12);
}

TEST(Laws, AbsentInputsGiveNothing) {
  const arm::Arm arm = table_1_arm();
  const arm::Segment& segment = arm.segments[0];
  EXPECT_FALSE(arm::predict_segment(arm, segment, {}));
  EXPECT_FALSE(arm::predict_segment(arm, segment, {0.0, 0.0, 0.0}));  // the vacuum is missing
  EXPECT_FALSE(arm::predict_segment(arm, segment, {0.0, std::nullopt, 0.0, 0.0}));
  EXPECT_FALSE(arm::predict_segment(arm, segment, {0.0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  EXPECT_TRUE(arm::predict_segment(arm, segment, {0.0, 0.0, 0.0, 0.0}));
}

TEST(Laws, VacuumIsNotNeededWithoutACore) {
  arm::Arm arm = table_1_arm();
  arm.segments[0].bending_stiffness.per_jamming_pressure_nm2_per_pa = 0.0;
  EXPECT_TRUE(arm::predict_segment(arm, arm.segments[0], {0.0, 0.0, 0.0}));
}

TEST(Laws, PassiveSegmentNeedsNoInputs) {
  arm::Arm arm = table_1_arm();
  arm.segments[0].chambers.clear();
  arm.segments[0].jamming_input.reset();
  const arm::SegmentPrediction passive = predicted(arm, {});
  EXPECT_DOUBLE_EQ(passive.bending_stiffness_nm2, 0.027);
  EXPECT_DOUBLE_EQ(passive.length_m, 0.2);
}

TEST(Laws, PressuresBelowAmbientTakeNoStiffnessAway) {
  EXPECT_DOUBLE_EQ(predicted(table_1_arm(), {-300.0, -300.0, -300.0, -100.0}).bending_stiffness_nm2, 0.027);
}

TEST(Laws, NoLengthIsNoPrediction) {
  const arm::Arm arm = table_1_arm();
  EXPECT_FALSE(arm::predict_segment(arm, arm.segments[0], {-1e6, -1e6, -1e6, 0.0}));
}

TEST(Laws, InputsAreFoundByName) {
  arm::Arm arm = table_1_arm();
  std::swap(arm.inputs.scalars[0], arm.inputs.scalars[2]);
  EXPECT_NEAR(direction(predicted(arm, {0.0, 0.0, 50e3, 0.0})), 0.0, 1e-12);
}

}  // namespace
}  // namespace softarm
