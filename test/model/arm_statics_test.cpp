// The shape of an arm and its derivatives, against differences of whole solutions.
#include "model/arm_statics.h"

#include <gmock/gmock.h>

#include "effects/body_fixture.h"

namespace softarm::model {
namespace {

using Outcome = ArmStatics::Outcome;

/// Off every zero and every kink of the laws.
StaticLoad usual_load(const arm::Arm& arm) {
  StaticLoad load;
  double share = 0.4;
  for (const arm::ScalarInput& input : arm.inputs.scalars) {
    const bool pneumatic = input.kind == arm::InputKind::kPressure || input.kind == arm::InputKind::kVacuum;
    load.inputs.push_back(share * (pneumatic ? 4e4 : input.kind == arm::InputKind::kTension ? 2.0 : 0.5));
    share += 0.13;
  }
  load.payload_kg = 0.05;
  load.gravity_base = Eigen::Vector3d(2.0, -1.0, -9.0);
  return load;
}

std::vector<double> places(const arm::Arm& arm) {
  return {0.3 * arm.total_length_m(), arm.total_length_m()};
}

Eigen::VectorXd solved_places(ArmStatics& statics, const arm::Arm& arm, const StaticLoad& load) {
  EXPECT_EQ(statics.solve(load), Outcome::kSolved);
  const int bodies = static_cast<int>(arm.bodies.size());
  Eigen::VectorXd all(3 * bodies + 6);
  for (int i = 0; i < bodies; ++i) all.segment<3>(3 * i) = statics.body_position(i);
  for (int i = 0; i < 2; ++i) all.segment<3>(3 * (bodies + i)) = statics.point(i).p;
  return all;
}

Eigen::VectorXd solved_places(const arm::Arm& arm, const StaticLoad& load) {
  ArmStatics statics(arm, places(arm));
  return solved_places(statics, arm, load);
}

void expect_same(const Eigen::VectorXd& derivative, const Eigen::VectorXd& above,
                 const Eigen::VectorXd& below, double step, const std::string& what) {
  const Eigen::VectorXd expected = (above - below) / (2.0 * step);
  // Of differences of 1e-10 m there are that many left; of the derivative itself a ten-thousandth.
  const double tolerance = 1e-4 * expected.norm() + 2e-10 / step;
  EXPECT_LT((derivative - expected).norm(), tolerance) << what << "\n"
                                                       << derivative.transpose() << "\n"
                                                       << expected.transpose();
}

class Statics : public ::testing::TestWithParam<const char*> {};

TEST_P(Statics, DerivativesAreThoseOfTheSolutions) {
  const arm::Arm arm = effects::body_testing::shipped(GetParam());
  const StaticLoad load = usual_load(arm);
  ArmStatics statics(arm, places(arm));
  solved_places(statics, arm, load);
  const Eigen::MatrixXd by_inputs = statics.by_inputs(), by_gravity = statics.by_gravity();
  const Eigen::VectorXd by_payload = statics.by_payload();
  const auto moved = [&](auto change, double step) {
    StaticLoad other = load;
    change(other, step);
    return solved_places(arm, other);
  };
  for (std::size_t i = 0; i < load.inputs.size(); ++i) {
    const double step = 1e-3 * *load.inputs[i];
    const auto change = [&](StaticLoad& l, double by) { *l.inputs[i] += by; };
    expect_same(by_inputs.col(static_cast<int>(i)), moved(change, step), moved(change, -step), step,
                arm.inputs.scalars[i].name);
  }
  const auto heavier = [](StaticLoad& l, double by) { l.payload_kg += by; };
  expect_same(by_payload, moved(heavier, 1e-4), moved(heavier, -1e-4), 1e-4, "payload");
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [&](StaticLoad& l, double by) { l.gravity_base[axis] += by; };
    expect_same(by_gravity.col(axis), moved(turned, 1e-3), moved(turned, -1e-3), 1e-3, "gravity");
  }
}

TEST_P(Statics, DerivativesByConstantsAreThoseOfOtherArms) {
  const arm::Arm arm = effects::body_testing::shipped(GetParam());
  const StaticLoad load = usual_load(arm);
  ArmStatics statics(arm, places(arm));
  solved_places(statics, arm, load);
  std::vector<arm::ConstantRef> constants;
  for (const arm::ConstantRef& constant : arm::constants_of(arm)) {
    // The backbone's points stay where they are along the arm; a length moves them.
    const bool wall = arm::role_of(constant.kind) == arm::ConstantRole::kWall;
    if (!wall && constant.kind != arm::ConstantKind::kLength && arm::value_of(arm, constant) != 0.0)
      constants.push_back(constant);
  }
  ASSERT_THAT(constants, ::testing::Not(::testing::IsEmpty()));
  const Eigen::MatrixXd by_constants = statics.by_constants(constants);
  for (std::size_t j = 0; j < constants.size(); ++j) {
    const double value = arm::value_of(arm, constants[j]), step = 1e-4 * std::abs(value);
    const auto with = [&](double to) {
      arm::Arm other = arm;
      arm::set_value(other, constants[j], to);
      return solved_places(other, load);
    };
    expect_same(by_constants.col(static_cast<int>(j)), with(value + step), with(value - step), step,
                arm::name_of(arm, constants[j]));
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, Statics,
                         ::testing::Values("online_200mm", "semi_physical_200mm", "two_segment",
                                           "hybrid_85mm", "cable_235mm", "tendon_trunk", "pouch_arm"));

TEST(Statics, LengthCarriesTheBodiesAlong) {
  const arm::Arm arm = effects::body_testing::shipped("online_200mm");
  const StaticLoad load = usual_load(arm);
  std::vector<arm::ConstantRef> lengths;
  for (const arm::ConstantRef& constant : arm::constants_of(arm))
    if (constant.kind == arm::ConstantKind::kLength) lengths.push_back(constant);
  ASSERT_EQ(lengths.size(), 1u);
  ArmStatics statics(arm, {});
  ASSERT_EQ(statics.solve(load), Outcome::kSolved);
  const Eigen::MatrixXd by = statics.by_constants(lengths);
  const double step = 1e-5;
  arm::Arm longer = arm;
  arm::set_value(longer, lengths[0], arm.total_length_m() + step);
  ArmStatics other(longer, {});
  ASSERT_EQ(other.solve(load), Outcome::kSolved);
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) {
    const Eigen::Vector3d expected = (other.body_position(i) - statics.body_position(i)) / step;
    EXPECT_LT((by.block<3, 1>(3 * i, 0) - expected).norm(), 1e-3) << i;
  }
}

TEST(Statics, SaysWhatKeepsItFromAShape) {
  const arm::Arm arm = effects::body_testing::shipped("online_200mm");
  ArmStatics statics(arm, {});
  StaticLoad load = usual_load(arm);
  load.inputs[0].reset();
  EXPECT_EQ(statics.solve(load), Outcome::kNoLaws);
}

}  // namespace
}  // namespace softarm::model
