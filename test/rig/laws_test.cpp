// What the inputs make of a segment, against hand-computed cases.
#include "rig/laws.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rig/scenario_text.h"

namespace softarm::rig {
namespace {

SegmentSpec pneumatic_segment() {
  return parse_scenario(kScenarioText, "case.yaml").arm.segments[0];
}

TEST(SemiPhysicalLaws, SignsAreThoseOfTheGeometry) {
  SegmentSpec arm = pneumatic_segment();
  for (std::size_t i = 0; i < 3; ++i) {
    Commands commands;
    commands.pressures_pa.assign(3, 0.0);
    commands.pressures_pa[i] = 20e3;
    const Eigen::Vector2d moment = apply_laws(arm, commands).moment_nm;
    const double direction = arm.chambers[i].direction_rad;
    EXPECT_NEAR(moment.x(), arm.chambers[i].moment_gain_nm_per_pa * 20e3 * std::cos(direction), 1e-12);
    EXPECT_NEAR(moment.y(), arm.chambers[i].moment_gain_nm_per_pa * 20e3 * std::sin(direction), 1e-12);
  }
  for (ChamberSpec& chamber : arm.chambers) chamber.moment_gain_nm_per_pa = 7e-6;
  Commands even;
  even.pressures_pa.assign(3, 30e3);
  EXPECT_LT(apply_laws(arm, even).moment_nm.norm(), 1e-12);
}

TEST(SemiPhysicalLaws, StiffnessAndLength) {
  SegmentSpec arm = pneumatic_segment();
  arm.stiffness_per_jamming_nm2_per_pa = 1e-7;
  Commands commands;
  commands.pressures_pa = {10e3, 40e3, 25e3};
  commands.vacuum_pa = 50e3;
  const Actuation a = apply_laws(arm, commands);
  EXPECT_NEAR(a.bending_stiffness_nm2, 0.027 + 3e-7 * 10e3 + 1e-7 * (50e3 + 25e3), 1e-12);
  EXPECT_NEAR(a.length_m, 0.2 + 3e-8 * 10e3 + 2e-8 * 40e3, 1e-12);
}

TEST(SemiPhysicalLaws, ChambersTakeTheInputsThatTheyName) {
  SegmentSpec arm = pneumatic_segment();
  arm.chambers[0].input = 4;
  Commands commands;
  commands.pressures_pa = {0.0, 0.0, 0.0, 0.0, 10e3};
  EXPECT_NEAR(apply_laws(arm, commands).moment_nm.x(), 0.061, 1e-12);
}

TEST(WallStretch, LinearMaterial) {
  const auto pulled = wall_stretch(3.0, 60.0, std::nullopt);
  ASSERT_TRUE(pulled);
  EXPECT_DOUBLE_EQ(pulled->stretch, 1.05);
  EXPECT_DOUBLE_EQ(pulled->modulus_ratio, 1.0);
  EXPECT_FALSE(wall_stretch(-61.0, 60.0, std::nullopt));
}

TEST(WallStretch, MooneyRivlinComputedByHand) {
  // C10 = 0.3, C01 = 0.2: E = 3. At a stretch of 1.25: (0.3 + 0.16)(1.25 - 0.64) 2 = 0.5612; modulus
  // 2 [0.3 (1 + 2 / 1.953125) + 3 * 0.2 / 2.44140625] = 1.7059.
  const auto pulled = wall_stretch(0.5612 / 3.0 * 50.0, 50.0, MaterialSpec{0.3, 0.2});
  ASSERT_TRUE(pulled);
  EXPECT_NEAR(pulled->stretch, 1.25, 1e-9);
  EXPECT_NEAR(pulled->modulus_ratio, 1.70592 / 3.0, 1e-6);
  // The hybrid paper's rubber, C10 = 0.0188, C01 = -0.014 (E = 0.0288), at 0.95:
  // 2 (0.0188 - 0.0147368421)(0.95 - 1.1080332410) = -0.00128422...
  const double force = 2.0 * (0.0188 - 0.014 / 0.95) * (0.95 - 1.0 / 0.9025) / 0.0288 * 68.0;
  const auto pressed = wall_stretch(force, 68.0, MaterialSpec{0.0188, -0.014});
  ASSERT_TRUE(pressed);
  EXPECT_NEAR(pressed->stretch, 0.95, 1e-9);
  // 2 [0.0188 (1 + 2 / 0.857375) - 0.042 / 0.81450625] / 0.0288
  EXPECT_NEAR(pressed->modulus_ratio, 0.770126, 1e-6);
}

TEST(WallStretch, ModulusIsTheDerivativeOfTheForce) {
  for (const MaterialSpec& m :
       {MaterialSpec{277e3, -209e3}, MaterialSpec{0.0188, -0.014}, MaterialSpec{1.0, 1.0}})
    for (double force : {-2.0, -0.5, 0.0, 0.3, 4.0}) {
      const double h = 1e-3;
      const auto at = wall_stretch(force, 68.0, m), low = wall_stretch(force - h, 68.0, m),
                 high = wall_stretch(force + h, 68.0, m);
      ASSERT_TRUE(at && low && high);
      EXPECT_NEAR(2.0 * h / 68.0 / (high->stretch - low->stretch), at->modulus_ratio, 1e-5) << force;
    }
  EXPECT_NEAR(wall_stretch(0.0, 68.0, MaterialSpec{1.0, 1.0})->modulus_ratio, 1.0, 1e-12);
}

TEST(WallStretch, WithoutAStableStretchIsRefused) {
  // This rubber's force in compression is at most where 0.0188 (1 + 2 x^-3) = 0.042 x^-4, x = 0.8505.
  const MaterialSpec rubber{0.0188, -0.014};
  const double x = 0.8505;
  const double most = 2.0 * (0.0188 - 0.014 / x) * (x - 1.0 / (x * x)) / 0.0288;
  EXPECT_TRUE(wall_stretch(0.95 * most * 68.0, 68.0, rubber));
  EXPECT_FALSE(wall_stretch(1.05 * most * 68.0, 68.0, rubber));
}

TEST(Tendons, MomentTensionAndTwistStiffness) {
  SegmentSpec s;
  s.length_m = 0.085;
  s.stiffness_base_nm2 = 6.5e-4;
  s.torsional_stiffness_nm2 = 4e-4;
  s.axial_stiffness_n = 60.0;
  s.tendons = {{0, 0.0, 0.004}, {1, 2.0 * M_PI / 3.0, 0.004}, {2, -2.0 * M_PI / 3.0, 0.004}};
  s.central_chamber = CentralChamberSpec{0, 7e-6};
  Commands c;
  c.tensions_n = {0.0, 3.0, 0.0};
  c.pressures_pa = {40e3};
  const Actuation a = apply_laws(s, c);
  EXPECT_NEAR(a.moment_nm.x(), -0.006, 1e-12);
  EXPECT_NEAR(a.moment_nm.y(), 0.012 * std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(a.length_m, 0.085 * (1.0 + (40e3 * 7e-6 - 3.0) / 60.0), 1e-12);
  EXPECT_NEAR(a.torsional_stiffness_nm2, 4e-4 + 3.0 * 16e-6, 1e-15);
  c.tensions_n = {2.0, 2.0, 2.0};
  EXPECT_LT(apply_laws(s, c).moment_nm.norm(), 1e-15);
  s.axial_stiffness_n.reset();  // rigid
  EXPECT_DOUBLE_EQ(apply_laws(s, c).length_m, 0.085);
}

TEST(Tendons, HyperelasticWallSoftensUnderThemAndStiffensWithPressure) {
  SegmentSpec s;
  s.length_m = 0.085;
  s.stiffness_base_nm2 = 6.5e-4;
  s.torsional_stiffness_nm2 = 4e-4;
  s.axial_stiffness_n = 68.0;
  s.material = MaterialSpec{0.0188, -0.014};
  s.tendons = {{0, 0.0, 0.004}};
  s.central_chamber = CentralChamberSpec{0, 7e-6};
  Commands c;
  c.tensions_n = {2.5};
  c.pressures_pa = {0.0};
  const Actuation pulled = apply_laws(s, c);
  const auto wall = wall_stretch(-2.5, 68.0, s.material);
  EXPECT_DOUBLE_EQ(pulled.length_m, 0.085 * wall->stretch);
  EXPECT_DOUBLE_EQ(pulled.bending_stiffness_nm2, 6.5e-4 * wall->modulus_ratio);
  EXPECT_LT(pulled.bending_stiffness_nm2, 6.5e-4);
  c.pressures_pa = {40e3};
  EXPECT_GT(apply_laws(s, c).bending_stiffness_nm2, pulled.bending_stiffness_nm2);
  c.tensions_n = {20.0};
  EXPECT_THROW(apply_laws(s, c), LawError);
}

TEST(Cables, CurvatureOfTheWoundCable) {
  SegmentSpec s;
  s.length_m = 0.235;
  s.stiffness_base_nm2 = 0.007;
  s.cables = {{0, M_PI / 2.0, 0.010, 0.020}};
  Commands c;
  c.angles_rad = {0.4};
  const Actuation a = apply_laws(s, c);
  // 8 mm of cable over a lever of 10 mm: 0.8 rad along 0.235 m.
  EXPECT_NEAR(a.moment_nm.y() / a.bending_stiffness_nm2, 0.8 / 0.235, 1e-12);
  EXPECT_NEAR(a.moment_nm.x(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(a.length_m, 0.235);
}

TEST(StiffnessByPressure, LinearBetweenAndConstantBeyond) {
  SegmentSpec s;
  s.central_chamber = CentralChamberSpec{0, 7e-6};
  s.stiffness_by_pressure = {{0.0, 6e-4}, {10e3, 7e-4}, {40e3, 10e-4}};
  const auto at = [&](double pressure_pa) {
    Commands c;
    c.pressures_pa = {pressure_pa};
    return apply_laws(s, c).bending_stiffness_nm2;
  };
  EXPECT_DOUBLE_EQ(at(-5e3), 6e-4);
  EXPECT_NEAR(at(5e3), 6.5e-4, 1e-15);
  EXPECT_NEAR(at(25e3), 8.5e-4, 1e-15);
  EXPECT_DOUBLE_EQ(at(60e3), 10e-4);
}

}  // namespace
}  // namespace softarm::rig
