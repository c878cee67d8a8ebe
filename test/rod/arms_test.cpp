// From inputs to shapes, for every arm that ships: limits and symmetries of the laws and the rod together.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "softarm/arm/arm_file.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/solver.h"

namespace softarm::rod {
namespace {

const std::string kFolder = std::string(SOFTARM_SOURCE_DIR) + "/config/arms";

/// Some input of the size that the papers use; different for each.
arm::InputValues some_inputs(const arm::Arm& arm) {
  arm::InputValues inputs;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    const double share = 1.0 / (1.0 + static_cast<double>(i));
    switch (arm.inputs.scalars[i].kind) {
      case arm::InputKind::kPressure:
        inputs.emplace_back(30e3 * share);
        break;
      case arm::InputKind::kVacuum:
        inputs.emplace_back(40e3);
        break;
      case arm::InputKind::kTension:
        inputs.emplace_back(1.5 * share);
        break;
      case arm::InputKind::kAngle:
        inputs.emplace_back(0.4 * share);
        break;
    }
  }
  return inputs;
}

/// The arm's backbone in its base frame, gravity along the base's z axis (hanging) times `gravity`.
class Shape {
 public:
  Shape(const arm::Arm& arm, const arm::InputValues& inputs, double gravity = 9.80665,
        double payload_kg = 0.0)
      : rod_(rod::make_rod(arm)), solver_(rod_, {arm.total_length_m()}, {}) {
    const auto laws = predict(arm, inputs);
    if (!laws) throw std::logic_error("inputs outside the laws");
    rod::actuate(arm, *laws, rod_);
    rod_.gravity_m_s2 = {0.0, 0.0, gravity};
    rod_.loads[rod::kPayloadLoad].mass_kg = payload_kg;
    if (solver_.solve(rod_) != rod::SolveStatus::kConverged) throw std::logic_error("no equilibrium");
  }
  Eigen::Vector3d at(double share) const { return solver_.at(share * rod_.rest_length_m()).p; }

 private:
  rod::Rod rod_;
  rod::Solver solver_;
};

void turn_actuators(arm::Arm& arm, double angle_rad) {
  for (softarm::arm::Segment& segment : arm.segments) {
    for (arm::Chamber& chamber : segment.chambers) chamber.bending_direction_rad += angle_rad;
    for (arm::Tendon& tendon : segment.tendons) tendon.bending_direction_rad += angle_rad;
    for (arm::Cable& cable : segment.cables) cable.bending_direction_rad += angle_rad;
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    const Eigen::Vector3d rest = segment.rest_curvature_per_m;
    segment.rest_curvature_per_m = {c * rest.x() - s * rest.y(), s * rest.x() + c * rest.y(), rest.z()};
  }
}

class EveryArm : public ::testing::TestWithParam<std::string> {
 protected:
  arm::Arm arm() const { return arm::load_arm_file(GetParam(), {kFolder}); }
};

TEST_P(EveryArm, TurningItsActuatorsTurnsItsShape) {
  const arm::Arm before = arm();
  arm::Arm after = before;
  const double angle = 0.7;
  turn_actuators(after, angle);
  const arm::InputValues inputs = some_inputs(before);
  const Shape shape(before, inputs, 9.80665, 0.02), turned(after, inputs, 9.80665, 0.02);
  const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitZ());
  for (const double share : {0.25, 0.5, 0.75, 1.0})
    EXPECT_LT((turn * shape.at(share) - turned.at(share)).norm(), 1e-7 * before.total_length_m()) << share;
}

TEST_P(EveryArm, HangsAsItIsMadeWithoutInput) {
  arm::Arm made = arm();
  arm::InputValues inputs(made.inputs.scalars.size(), 0.0);
  for (softarm::arm::Segment& segment : made.segments) segment.rest_curvature_per_m.setZero();
  const Shape shape(made, inputs, 0.0);
  EXPECT_LT((shape.at(1.0) - made.total_length_m() * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST_P(EveryArm, WithoutLoadEverySegmentIsAnArcOfItsCurvature) {
  arm::Arm made = arm();
  made.segments.resize(1);
  made.bodies.clear();
  softarm::arm::Segment& segment = made.segments[0];
  segment.rest_curvature_per_m.setZero();
  segment.stiffness_profile.clear();
  made.payload.arclength_m = segment.length_m;
  const arm::InputValues inputs = some_inputs(made);
  const arm::SegmentPrediction law = arm::predict_segment(made, segment, inputs).value();
  segment.mass_per_length_kg_m = made.tip_mass_kg = 0.0;
  const Shape shape(made, inputs, 0.0);
  const Eigen::Vector2d bend = law.actuation_nm() / law.bending_stiffness_nm2;
  const double theta = bend.norm() * law.length_m;
  const Eigen::Vector3d tip = shape.at(1.0);
  if (theta < 1e-9) {
    EXPECT_LT((tip - law.length_m * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
    return;
  }
  const double across = (1.0 - std::cos(theta)) / bend.norm();
  EXPECT_NEAR(tip.z(), std::sin(theta) / bend.norm(), 1e-8);
  EXPECT_LT((tip.head<2>() - across * bend.normalized()).norm(), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryArm, ::testing::ValuesIn(arm::arm_names({kFolder})),
                         [](const auto& arm) { return arm.param; });

TEST(SeveralSegments, OfDifferentDriveAreTheOnesAloneInSeries) {
  const arm::Arm both = arm::load_arm_file("two_segment", {kFolder});
  const arm::InputValues inputs = some_inputs(both);
  arm::Arm weightless = both;
  for (softarm::arm::Segment& segment : weightless.segments) segment.mass_per_length_kg_m = 0.0;
  const Shape shape(weightless, inputs, 0.0);
  // Without load each segment is an arc by itself, the second on the end of the first.
  Eigen::Isometry3d end = Eigen::Isometry3d::Identity();
  for (const softarm::arm::Segment& segment : both.segments) {
    const arm::SegmentPrediction law = arm::predict_segment(both, segment, inputs).value();
    const Eigen::Vector2d bend = law.actuation_nm() / law.bending_stiffness_nm2;
    const double theta = bend.norm() * law.length_m;
    Eigen::Isometry3d arc = Eigen::Isometry3d::Identity();
    const Eigen::Vector2d towards = bend.normalized();
    arc.translation() << (1.0 - std::cos(theta)) / bend.norm() * towards, std::sin(theta) / bend.norm();
    arc.linear() =
        Eigen::AngleAxisd(theta, Eigen::Vector3d(-towards.y(), towards.x(), 0.0)).toRotationMatrix();
    end = end * arc;
  }
  EXPECT_LT((shape.at(1.0) - end.translation()).norm(), 1e-8);
}

TEST(Tendon, OnTheAxisOnlyShortens) {
  arm::Arm arm = arm::load_arm_file("hybrid_85mm", {kFolder});
  for (arm::Tendon& tendon : arm.segments[0].tendons) tendon.offset_m = 0.0;
  arm::InputValues inputs(arm.inputs.scalars.size(), 0.0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (arm.inputs.scalars[i].kind == arm::InputKind::kTension) inputs[i] = 2.0;
  }
  const Shape shape(arm, inputs, 0.0);
  const double shortened = arm.segments[0].length_m * (1.0 - 6.0 / *arm.segments[0].axial_stiffness_n);
  EXPECT_LT((shape.at(1.0) - shortened * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(Tendon, PulledInSequenceTurnsTheTipByAThirdOfATurnEachTime) {
  const arm::Arm arm = arm::load_arm_file("hybrid_85mm", {kFolder});
  std::vector<Eigen::Vector3d> tips;
  for (int pulled = 0; pulled < 3; ++pulled) {
    arm::InputValues inputs;
    int tendon = 0;
    for (const arm::ScalarInput& input : arm.inputs.scalars)
      inputs.emplace_back(input.kind == arm::InputKind::kTension && tendon++ == pulled ? 2.0 : 0.0);
    tips.push_back(Shape(arm, inputs).at(1.0));
  }
  const Eigen::AngleAxisd third(2.0 * M_PI / 3.0, Eigen::Vector3d::UnitZ());
  EXPECT_GT(tips[0].head<2>().norm(), 0.02);
  EXPECT_LT((third * tips[0] - tips[1]).norm(), 1e-9);
  EXPECT_LT((third * tips[1] - tips[2]).norm(), 1e-9);
}

}  // namespace
}  // namespace softarm::rod
