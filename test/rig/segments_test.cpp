// Rods of several pieces, loads within, a yielding base, shear and stretch: against a chain of links and
// closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/arm_cut.h"
#include "rig/chain.h"
#include "rig/rods.h"

namespace softarm::rig {
namespace {

/// A proximal piece and a weaker distal one that is bent elsewhere.
struct TwoPieces {
  RitzRodParams params;
  RitzRodInputs inputs;
  Chain chain;

  explicit TwoPieces(const Eigen::Vector3d& gravity) {
    params.pieces = {{6, 0.6, 0.12, 0.04, 0.0}, {6, 0.4, 0.05, 0.03, 0.0}};
    params.gravity_base_m_s2 = chain.gravity = gravity;
    inputs.pieces.resize(2);
    inputs.pieces[0] = {0.15, 0.03, 0.02, {-0.1, 0.2, 0.0}, {}, {}};
    inputs.pieces[1] = {0.1, 0.008, 0.006, {0.03, -0.05, 0.01}, {}, {}};
    inputs.payload_kg = 0.08;
    chain.parts.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
      chain.parts[i].length_m = inputs.pieces[i].length_m;
      chain.parts[i].mass_kg = params.pieces[i].mass_kg;
      chain.parts[i].bending_stiffness_nm2 = inputs.pieces[i].bending_stiffness_nm2;
      chain.parts[i].torsional_stiffness_nm2 = inputs.pieces[i].torsional_stiffness_nm2;
      chain.parts[i].moment_section_nm = inputs.pieces[i].moment_section_nm;
    }
    chain.parts[1].payload_kg = inputs.payload_kg;
  }

  void compare(double tolerance_m) {
    ASSERT_TRUE(chain.solve());
    RitzRod rod(params);
    ASSERT_TRUE(rod.settle(inputs));
    const double joint = params.pieces[0].share;
    for (int i = 0; i <= 4; ++i) {
      const std::size_t of_first = static_cast<std::size_t>(i * chain.parts[0].links / 4);
      const std::size_t of_second =
          static_cast<std::size_t>(chain.parts[0].links + i * chain.parts[1].links / 4);
      EXPECT_LT((rod.pose(joint * i / 4.0).translation() - chain.positions[of_first]).norm(), tolerance_m)
          << i;
      EXPECT_LT((rod.pose(joint + (1.0 - joint) * i / 4.0).translation() - chain.positions[of_second]).norm(),
                tolerance_m)
          << i;
    }
  }
};

TEST(RigSegments, TwoPiecesAgreeWithAChainOfLinks) {
  for (const Eigen::Vector3d& gravity :
       {Eigen::Vector3d(0.0, 0.0, 9.81), Eigen::Vector3d(-9.81, 0.0, 0.0), Eigen::Vector3d(3.0, -4.0, 8.0)}) {
    TwoPieces two(gravity);
    two.compare(1e-6);
  }
}

TEST(RigSegments, ShearStretchYieldingBaseAndPayloadAtTheJoint) {
  TwoPieces two(Eigen::Vector3d(6.0, -3.0, 5.0));
  two.inputs.pieces[0].shear_stiffness_n = two.chain.parts[0].shear_stiffness_n = 40.0;
  two.inputs.pieces[0].axial_stiffness_n = two.chain.parts[0].axial_stiffness_n = 150.0;
  two.inputs.pieces[1].shear_stiffness_n = two.chain.parts[1].shear_stiffness_n = 25.0;
  two.params.base_stiffness_nm_per_rad = two.chain.base_stiffness_nm_per_rad = 2.0;
  two.params.payload_piece = 0;
  std::swap(two.chain.parts[0].payload_kg, two.chain.parts[1].payload_kg);
  two.compare(2e-6);
}

TEST(RigSegments, CurvatureJumpsWherePiecesMeet) {
  TwoPieces two(Eigen::Vector3d::Zero());
  RitzRod rod(two.params);
  ASSERT_TRUE(rod.settle(two.inputs));
  EXPECT_NEAR(rod.curvature(0.6 - 1e-9).y(), 0.2 / 0.03, 1e-7);
  EXPECT_NEAR(rod.curvature(0.6).y(), -0.05 / 0.008, 1e-7);
}

TEST(RigSegments, CuttingAUniformRodChangesNothing) {
  RitzRodParams whole = paper_rod(12), cut = whole;
  whole.gravity_base_m_s2 = cut.gravity_base_m_s2 = {4.0, 6.0, -6.0};
  cut.pieces = {{6, 0.3, 0.06, 0.04, 0.0}, {6, 0.7, 0.14, 0.04, 0.0}};
  RitzRodInputs one = paper_inputs();
  one.pieces[0].moment_section_nm = {-0.1, 0.3, 0.0};
  one.payload_kg = 0.1;
  RitzRodInputs two = one;
  two.pieces.assign(2, one.pieces[0]);
  two.pieces[0].length_m = 0.06;
  two.pieces[1].length_m = 0.14;
  RitzRod a(whole), b(cut);
  ASSERT_TRUE(a.settle(one) && b.settle(two));
  for (int i = 0; i < 40; ++i) {
    one.payload_kg = two.payload_kg = 0.15;
    ASSERT_TRUE(a.step(one, 2e-3) && b.step(two, 2e-3));
    for (double fraction : {0.2, 0.3, 0.8, 1.0})
      ASSERT_LT((a.pose(fraction).translation() - b.pose(fraction).translation()).norm(), 2e-7);
  }
  EXPECT_GT(a.velocity(1.0).norm(), 0.01);
  EXPECT_LT((a.velocity(1.0) - b.velocity(1.0)).norm(), 1e-4 * a.velocity(1.0).norm());
}

TEST(RigSegments, PayloadWithinIsTheCantileversFormula) {
  // Small deflections: at the load P a^3 / 3 EI, at the tip P a^2 (3 L - a) / 6 EI.
  const double a = 0.08, length = 0.2, kg = 2e-4, weight = kg * 10.0;
  RitzRodParams params = paper_rod();
  params.pieces = {{4, 0.4, 1e-9, 0.04, 0.0}, {5, 0.6, 1e-9, 0.04, 0.0}};
  params.payload_piece = 0;
  params.gravity_base_m_s2 = {10.0, 0.0, 0.0};
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces.assign(2, inputs.pieces[0]);
  inputs.pieces[0].length_m = a;
  inputs.pieces[1].length_m = length - a;
  inputs.payload_kg = kg;
  RitzRod rod(params);
  ASSERT_TRUE(rod.settle(inputs));
  EXPECT_NEAR(rod.pose(0.4).translation().x(), weight * a * a * a / 3.0 / 0.03, 1e-9);
  EXPECT_NEAR(rod.pose(1.0).translation().x(), weight * a * a * (3.0 * length - a) / 6.0 / 0.03, 1e-9);
  EXPECT_NEAR(rod.curvature(0.7).norm(), 0.0, 1e-7);  // no load beyond
}

TEST(RigSegments, BaseTurnsByMomentOverStiffness) {
  RitzRodParams params = paper_rod();
  params.gravity_base_m_s2 = {0.0, 9.81, 0.0};
  params.base_stiffness_nm_per_rad = 5.0;
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.payload_kg = 0.1;
  ASSERT_TRUE(rod.settle(inputs));
  // The weights' moment about the base, from the shape.
  double moment = 0.1 * 9.81 * rod.pose(1.0).translation().z();
  for (int i = 0; i < 2000; ++i) moment += 0.2 / 2000 * 9.81 * rod.pose((i + 0.5) / 2000).translation().z();
  EXPECT_GT(moment, 0.2);
  EXPECT_NEAR(rod.base_rotation().x(), -moment / 5.0, 1e-7);
  EXPECT_NEAR(rod.base_rotation().y(), 0.0, 1e-12);
  const Eigen::Vector3d tangent = rod.pose(0.0).linear().col(2);
  EXPECT_NEAR(std::atan2(tangent.y(), tangent.z()), moment / 5.0, 1e-7);
}

TEST(RigSegments, ActuationAloneDoesNotTurnTheBase) {
  RitzRodParams params = paper_rod();
  params.base_stiffness_nm_per_rad = 5.0;
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].moment_section_nm = {0.1, 0.3, 0.0};
  ASSERT_TRUE(rod.settle(inputs));
  EXPECT_LT(rod.base_rotation().norm(), 1e-9);
}

TEST(RigSegments, DampedMotionSettlesToStatics) {
  TwoPieces two(Eigen::Vector3d(0.0, 4.0, 8.0));
  for (RodPiece& piece : two.params.pieces) piece.retardation_s = 0.08;
  two.params.base_stiffness_nm_per_rad = 3.0;
  for (PieceInputs& piece : two.inputs.pieces) piece.shear_stiffness_n = piece.axial_stiffness_n = 40.0;
  RitzRod moving(two.params), rest(two.params);
  RitzRodInputs start = two.inputs;
  start.payload_kg = 0.0;
  start.pieces[0].moment_section_nm.setZero();
  ASSERT_TRUE(moving.settle(start) && rest.settle(two.inputs));
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 480 * 8; ++i) {
    ASSERT_TRUE(moving.step(two.inputs, 1.0 / 480.0));
    const double energy = moving.energy_j() - rest.energy_j();
    if (i > 2) {
      ASSERT_LT(energy, last + 2e-5) << i;
    }
    last = energy;
  }
  EXPECT_NEAR(last, 0.0, 1e-7);
  EXPECT_LT((moving.pose(1.0).translation() - rest.pose(1.0).translation()).norm(), 5e-6);
}

TEST(RigSegments, MisfitsOfPiecesAreRefused) {
  RitzRodParams params = paper_rod();
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces.resize(2);
  EXPECT_THROW(rod.settle(inputs), std::invalid_argument);
  EXPECT_THROW(rod.step(inputs, 0.01), std::invalid_argument);
  params.pieces[0].share = 0.5;
  EXPECT_THROW(RitzRod{params}, std::invalid_argument);
  params.pieces.clear();
  EXPECT_THROW(RitzRod{params}, std::invalid_argument);
}

/// Where the tip of a two-segment arm is in equilibrium, base frame.
Eigen::Vector3d settled_tip(const Scenario& scenario) {
  const Cut cut = cut_arm(scenario);
  RitzRod rod(rod_params(scenario, cut));
  std::vector<Actuation> actuation;
  for (const SegmentSpec& segment : scenario.arm.segments) actuation.push_back(apply_laws(segment, Acting{}));
  RitzRodInputs inputs;
  inputs.pieces = piece_inputs(cut, actuation);
  EXPECT_TRUE(rod.settle(inputs));
  return rod.pose(1.0).translation();
}

// A joint turns as a hinge at its middle: against the hinge of the base, whose place differs by half its
// length.
TEST(RigSegments, AJointTurnsAsAHingeDoes) {
  const std::string text = R"(format: 1
name: joint
duration_s: 0
arm:
  segments:
    - {length_m: 0.1, mass_kg: 0.05, bending_stiffness: {base_nm2: 0.03})",
                    rest = R"(}
    - {length_m: 0.1, mass_kg: 0.05, bending_stiffness: {base_nm2: 0.02}}
mount: {position_m: [0, 0, 1], attitude: horizontal}
)";
  Scenario hinge = parse_scenario(text + rest, "s.yaml");
  const Eigen::Vector3d rigid = settled_tip(hinge);
  hinge.body.base_stiffness_nm_per_rad = 1.5;
  const double by_hinge_m = (settled_tip(hinge) - rigid).norm();
  const auto by_joint_m = [&](const char* length) {
    return (settled_tip(parse_scenario(
                text + ", joint: {stiffness_nm_per_rad: 1.5, length_m: " + length + "}" + rest, "s.yaml")) -
            rigid)
        .norm();
  };
  EXPECT_GT(by_hinge_m, 0.01);
  const double off_2mm = by_joint_m("0.002") - by_hinge_m, off_4mm = by_joint_m("0.004") - by_hinge_m;
  EXPECT_LT(std::abs(off_2mm), 0.02 * by_hinge_m);
  EXPECT_NEAR(off_4mm / off_2mm, 2.0, 0.2);
}

}  // namespace
}  // namespace softarm::rig
