// The rig's static limit against closed forms and an independent elastica.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rig/rods.h"

namespace softarm::rig {
namespace {

TEST(RigStatics, PureMomentBendsToACircle) {
  for (double moment : {0.05, 0.3, 0.6}) {
    RitzRod rod(paper_rod());
    RitzRodInputs inputs = paper_inputs();
    inputs.pieces[0].moment_section_nm = {0.0, moment, 0.0};
    ASSERT_TRUE(rod.settle(inputs));
    const double curvature = moment / 0.03;
    for (double fraction : {0.1, 0.25, 0.5, 0.77, 1.0}) {
      const double angle = curvature * fraction * 0.2;
      const Eigen::Isometry3d pose = rod.pose(fraction);
      const Eigen::Vector3d expected((1.0 - std::cos(angle)) / curvature, 0.0, std::sin(angle) / curvature);
      EXPECT_LT((pose.translation() - expected).norm(), 5e-8) << moment << " " << fraction;
      EXPECT_LT((pose.linear().col(2) - Eigen::Vector3d(std::sin(angle), 0.0, std::cos(angle))).norm(), 1e-7);
    }
  }
}

TEST(RigStatics, MomentAndTwistGiveAHelix) {
  RitzRod rod(paper_rod());
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].torsional_stiffness_nm2 = 0.02;
  inputs.pieces[0].moment_section_nm = {0.18, 0.24, 0.2};
  ASSERT_TRUE(rod.settle(inputs));
  // u is constant: the rod turns about a fixed axis along u, R(s) = exp(u s).
  const Eigen::Vector3d u(6.0, 8.0, 10.0), axis = u.normalized();
  for (double fraction : {0.3, 0.5, 1.0}) {
    const double s = 0.2 * fraction, a = u.norm() * s;
    const Eigen::Vector3d e3 = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d along = axis * axis.dot(e3), across = e3 - along;
    const Eigen::Vector3d expected =
        along * s + (std::sin(a) * across + (1.0 - std::cos(a)) * axis.cross(across)) / u.norm();
    EXPECT_LT((rod.pose(fraction).translation() - expected).norm(), 1e-8);
    EXPECT_LT((rod.curvature(fraction) - u).norm(), 1e-8);
  }
}

TEST(RigStatics, DeadTipLoadIsTheElastica) {
  // Tip deflection / L at F L^2 / EI, from the elliptic integrals (Bisshopp and Drucker 1945).
  const std::vector<std::pair<double, double>> table{{1, 0.30172}, {2, 0.49346}, {4, 0.66996}, {10, 0.81061}};
  for (const auto& [load, deflection] : table) {
    RitzRod rod(paper_rod());
    RitzRodInputs inputs = paper_inputs();
    inputs.tip_force_base_n = {load * 0.03 / 0.04, 0.0, 0.0};
    ASSERT_TRUE(rod.settle(inputs));
    EXPECT_NEAR(rod.pose(1.0).translation().x() / 0.2, deflection, 0.6e-5) << load;
  }
}

TEST(RigStatics, WeightPayloadAndActuationAgreeWithAnIndependentElastica) {
  struct Case {
    double gravity_x, gravity_z, moment, payload;
  };
  // Hanging (gravity along +z of the base frame), horizontal, inclined; up to 0.3 N m; the last tips over by
  // 150 degrees.
  for (const Case& c :
       {Case{0.0, 9.81, 0.3, 0.23}, Case{9.81, 0.0, -0.2, 0.1}, Case{-5.0, 8.0, 0.3, 0.23},
        Case{0.0, 9.81, 0.1, 0.0}, Case{0.0, -9.81, 0.15, 0.02}, Case{0.0, 9.81, 0.55, 0.1}}) {
    RitzRodParams params = paper_rod();
    params.gravity_base_m_s2 = {c.gravity_x, 0.0, c.gravity_z};
    RitzRod rod(params);
    RitzRodInputs inputs = paper_inputs();
    inputs.pieces[0].moment_section_nm = {0.0, c.moment, 0.0};
    inputs.payload_kg = c.payload;
    ASSERT_TRUE(rod.settle(inputs));
    PlanarElastica reference;
    reference.moment_nm = c.moment;
    reference.payload_kg = c.payload;
    reference.gravity_x = c.gravity_x;
    reference.gravity_z = c.gravity_z;
    const std::vector<Eigen::Vector2d> points = reference.solve(4000);
    for (int i = 1; i <= 8; ++i) {
      const Eigen::Vector2d expected = points[static_cast<std::size_t>(500 * i)];
      const Eigen::Vector3d p = rod.pose(i / 8.0).translation();
      EXPECT_NEAR(p.x(), expected.x(), 1e-6) << c.moment << " " << i;
      EXPECT_NEAR(p.z(), expected.y(), 1e-6) << c.moment << " " << i;
      EXPECT_NEAR(p.y(), 0.0, 1e-9);
    }
  }
}

TEST(RigStatics, MomentsBalanceAtEverySectionInThreeDimensions) {
  RitzRodParams params = paper_rod(10);
  params.gravity_base_m_s2 = {3.0, -4.0, 8.0};
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].torsional_stiffness_nm2 = 0.02;
  inputs.pieces[0].moment_section_nm = {-0.1, 0.25, 0.03};
  inputs.payload_kg = 0.2;
  inputs.tip_force_base_n = {0.3, 0.5, -0.2};
  ASSERT_TRUE(rod.settle(inputs));
  const Eigen::Vector3d tip_load = inputs.payload_kg * params.gravity_base_m_s2 + inputs.tip_force_base_n;
  const Eigen::Vector3d tip = rod.pose(1.0).translation();
  for (double fraction : {0.0, 0.21, 0.5, 0.83, 1.0}) {
    const Eigen::Isometry3d section = rod.pose(fraction);
    const Eigen::Vector3d strain = rod.curvature(fraction);
    const Eigen::Vector3d internal =
        section.linear() * (Eigen::Vector3d(0.03 * strain.x(), 0.03 * strain.y(), 0.02 * strain.z()) -
                            inputs.pieces[0].moment_section_nm);
    Eigen::Vector3d external = (tip - section.translation()).cross(tip_load);
    const int slices = 2000;  // midpoint rule over the weight beyond the section
    for (int i = 0; i < slices; ++i) {
      const double at = fraction + (1.0 - fraction) * (i + 0.5) / slices;
      external += (rod.pose(at).translation() - section.translation())
                      .cross(params.pieces[0].mass_kg * (1.0 - fraction) / slices * params.gravity_base_m_s2);
    }
    EXPECT_LT((internal - external).norm(), 1e-4 * 0.3) << fraction;
  }
}

TEST(RigStatics, ConvergesFasterThanSecondOrderInElements) {
  const auto tip = [](int elements) {
    RitzRodParams params = paper_rod(elements);
    params.gravity_base_m_s2 = {4.0, 6.0, -6.0};
    RitzRod rod(params);
    RitzRodInputs inputs = paper_inputs();
    inputs.pieces[0].moment_section_nm = {-0.1, 0.3, 0.0};
    inputs.payload_kg = 0.23;
    EXPECT_TRUE(rod.settle(inputs));
    return Eigen::Vector3d(rod.pose(1.0).translation());
  };
  const Eigen::Vector3d fine = tip(32);
  const double coarse_error = (tip(2) - fine).norm(), finer_error = (tip(4) - fine).norm();
  EXPECT_GT(std::log2(coarse_error / finer_error), 2.0);
  EXPECT_LT((tip(6) - fine).norm(), 2e-8);  // what the scenarios use, against the 2e-5 m allowed
}

TEST(RigStatics, TurningLoadsAboutTheBaseAxisTurnsTheShape) {
  const auto settled = [](double angle) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    RitzRodParams params = paper_rod();
    params.gravity_base_m_s2 = turn * Eigen::Vector3d(2.0, 5.0, 7.0);
    RitzRod rod(params);
    RitzRodInputs inputs = paper_inputs();
    inputs.pieces[0].moment_section_nm = turn * Eigen::Vector3d(-0.2, 0.2, 0.02);
    inputs.payload_kg = 0.2;
    EXPECT_TRUE(rod.settle(inputs));
    const Eigen::Isometry3d pose = rod.pose(1.0);
    return std::pair<Eigen::Vector3d, Eigen::Matrix3d>(turn.transpose() * pose.translation(),
                                                       turn.transpose() * pose.linear() * turn);
  };
  const auto reference = settled(0.0);
  for (double angle : {0.4, 1.7, -2.9}) {
    const auto turned = settled(angle);
    EXPECT_LT((turned.first - reference.first).norm(), 1e-10);
    EXPECT_LT((turned.second - reference.second).norm(), 1e-9);
  }
}

TEST(RigStatics, ImpossibleInputsAreRefusedAndLeaveTheStateAlone) {
  RitzRod rod(paper_rod());
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].moment_section_nm = {0.0, 0.2, 0.0};
  ASSERT_TRUE(rod.settle(inputs));
  const Eigen::Vector3d tip = rod.pose(1.0).translation();
  RitzRodInputs bad = inputs;
  bad.tip_force_base_n.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(rod.settle(bad));
  EXPECT_FALSE(rod.step(bad, 0.002));
  EXPECT_EQ(rod.pose(1.0).translation(), tip);
  EXPECT_TRUE(rod.step(inputs, 0.002));
  EXPECT_LT((rod.pose(1.0).translation() - tip).norm(), 1e-9);
}

}  // namespace
}  // namespace softarm::rig
