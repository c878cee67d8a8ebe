// The shape of an arm with effects: against the batch model's, against the laws alone, and its derivatives.
#include "model/extended_statics.h"

#include <gmock/gmock.h>

#include <cmath>

#include "effects/body_fixture.h"

namespace softarm::model {
namespace {

using Outcome = ExtendedStatics::Outcome;
using effects::body_testing::shipped;

StaticLoad bent(const arm::Arm& arm, const Eigen::Vector3d& gravity_base = {0.0, 0.0, 9.80665}) {
  StaticLoad load;
  const Eigen::VectorXd inputs = effects::body_testing::inputs_of(arm, 0.8);
  load.inputs.assign(inputs.data(), inputs.data() + inputs.size());
  load.payload_kg = 0.05;
  load.gravity_base = gravity_base;
  return load;
}

Present usual(const char* id) {
  const Effect* effect = effects::find(id);
  if (effect == nullptr) throw std::runtime_error(id);
  Values values(static_cast<Eigen::Index>(effect->info().parameters.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = effect->info().parameters[static_cast<std::size_t>(k)].usual;
  return {effect, values};
}

Eigen::VectorXd places_at(ExtendedStatics& statics, const arm::Arm& arm, const StaticLoad& load) {
  EXPECT_EQ(statics.solve(load), Outcome::kSolved);
  const int bodies = static_cast<int>(arm.bodies.size());
  Eigen::VectorXd all(3 * bodies + 3);
  for (int i = 0; i < bodies; ++i) all.segment<3>(3 * i) = statics.body_position(i);
  all.tail<3>() = statics.point(0).p;
  return all;
}

TEST(ExtendedStatics, IsTheLawsAloneWithoutEffects) {
  const arm::Arm arm = shipped("two_segment");
  ExtendedStatics statics(arm, {}, {arm.total_length_m()});
  ArmStatics plain(arm, {arm.total_length_m()});
  const StaticLoad load = bent(arm);
  ASSERT_EQ(plain.solve(load), Outcome::kSolved);
  const Eigen::VectorXd places = places_at(statics, arm, load);
  EXPECT_EQ((places.tail<3>() - plain.point(0).p).norm(), 0.0);
  EXPECT_TRUE(statics.by_inputs() == plain.by_inputs());
  EXPECT_THAT(statics.notes(), testing::IsEmpty());
}

class WithEffect : public ::testing::TestWithParam<const char*> {};

TEST_P(WithEffect, IsTheShapeOfADiagnosis) {
  const arm::Arm arm = shipped("online_200mm");
  const std::vector<Present> effects{usual(GetParam())};
  effects::body_testing::Condition condition;
  condition.inputs = effects::body_testing::inputs_of(arm, 0.8);
  condition.payload_kg = 0.05;
  ExtendedModel batch(arm);
  const TrialData trial = effects::body_testing::trial_of(arm, {condition});
  std::vector<Predicted> predicted, without;
  batch.predict(arm, effects, {false, 0.0}, trial, nullptr, predicted);
  batch.predict(arm, {}, {false, 0.0}, trial, nullptr, without);
  ASSERT_TRUE(predicted[0].solved && without[0].solved);

  ExtendedStatics statics(arm, effects, {arm.total_length_m()});
  ASSERT_THAT(statics.notes(),
              testing::ElementsAre(testing::HasSubstr("in the model: " + std::string(GetParam()))));
  const StaticLoad load = bent(arm, trial.blocks[0].gravity_base);
  const Eigen::VectorXd places = places_at(statics, arm, load);
  const Eigen::Map<const Eigen::Matrix3Xd> bodies(places.data(), 3, predicted[0].p.cols());
  EXPECT_LT((bodies - predicted[0].p).cwiseAbs().maxCoeff(), 2e-6);
  EXPECT_GT((without[0].p - predicted[0].p).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(ExtendedModel, LooksForEquilibriaOnlyWhereThereWereSomeIfToldSo) {
  const arm::Arm arm = shipped("online_200mm");
  effects::body_testing::Condition condition;
  condition.inputs = effects::body_testing::inputs_of(arm, 0.8);
  ExtendedModel model(arm);
  const TrialData trial = effects::body_testing::trial_of(arm, {condition, condition, condition});
  std::vector<Predicted> before, all, some;
  model.predict(arm, {}, {false, 0.0}, trial, nullptr, before);
  before[1].solved = false;
  model.predict(arm, {}, {false, 0.0}, trial, &before, all);
  model.predict(arm, {}, {false, 0.0}, trial, &before, some, true);
  EXPECT_TRUE(all[0].solved && all[1].solved && all[2].solved);
  EXPECT_TRUE(some[0].solved && !some[1].solved && some[2].solved);
  EXPECT_LT((some[2].p - all[2].p).cwiseAbs().maxCoeff(), 1e-8);
}

TEST_P(WithEffect, DerivativesAreThoseOfTheSolutions) {
  const arm::Arm arm = shipped("online_200mm");
  const std::vector<Present> effects{usual(GetParam())};
  ExtendedStatics statics(arm, effects, {arm.total_length_m()}),
      other = ExtendedStatics(arm, effects, {arm.total_length_m()});
  const StaticLoad load = bent(arm, {2.0, -1.0, 9.0});
  places_at(statics, arm, load);
  const auto expect = [&](const Eigen::VectorXd& derivative, double step, auto change,
                          const std::string& what) {
    StaticLoad above = load, below = load;
    change(above, step);
    change(below, -step);
    const Eigen::VectorXd expected =
        (places_at(other, arm, above) - places_at(other, arm, below)) / (2.0 * step);
    EXPECT_LT((derivative - expected).norm(), 2e-3 * expected.norm()) << what;
    EXPECT_GT(expected.norm(), 0.0) << what;
  };
  const Eigen::MatrixXd by_inputs = statics.by_inputs(), by_gravity = statics.by_gravity();
  for (int i = 0; i < 3; ++i)
    expect(
        by_inputs.col(i), 400.0,
        [&](StaticLoad& l, double by) { *l.inputs[static_cast<std::size_t>(i)] += by; },
        arm.inputs.scalars[static_cast<std::size_t>(i)].name);
  expect(
      statics.by_payload(), 3e-3, [](StaticLoad& l, double by) { l.payload_kg += by; }, "payload");
  for (int axis = 0; axis < 3; ++axis)
    expect(
        by_gravity.col(axis), 0.1, [&](StaticLoad& l, double by) { l.gravity_base[axis] += by; }, "gravity");

  const std::vector<arm::ConstantRef> constants{{arm::ConstantKind::kBendingStiffness, 0, 0}};
  const double value = arm::value_of(arm, constants[0]);
  const auto with_constant = [&](double by) {
    arm::Arm changed = arm;
    arm::set_value(changed, constants[0], value + by);
    ExtendedStatics changed_statics(changed, effects, {arm.total_length_m()});
    return places_at(changed_statics, changed, load);
  };
  const double step = 0.03 * value;
  const Eigen::VectorXd expected = (with_constant(step) - with_constant(-step)) / (2.0 * step);
  EXPECT_LT((statics.by_constants(constants).col(0) - expected).norm(), 2e-3 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Effects, WithEffect,
                         ::testing::Values("base_compliance", "curvature_softening", "payload_offset",
                                           "pressure_offset"));

TEST(ExtendedStatics, AtTheEdgeOfWhatIsAllowedItLooksToOneSide) {
  const arm::Arm arm = shipped("online_200mm");
  ExtendedStatics statics(arm, {usual("base_compliance")}, {arm.total_length_m()});
  StaticLoad load = bent(arm, {0.0, 5.0, 8.0});
  load.payload_kg = 0.0;
  places_at(statics, arm, load);
  const Eigen::VectorXd at_edge = statics.by_payload();
  load.payload_kg = 0.02;
  places_at(statics, arm, load);
  const Eigen::VectorXd inside = statics.by_payload();
  EXPECT_TRUE(at_edge.allFinite());
  EXPECT_GT(at_edge.norm(), 0.0);
  EXPECT_LT((at_edge - inside).norm(), 0.2 * inside.norm());
}

TEST(ExtendedStatics, RemembersInATrialAndNotElse) {
  const arm::Arm arm = shipped("online_200mm");
  ExtendedStatics statics(arm, {usual("hysteresis")}, {arm.total_length_m()});
  const auto load_at = [&](double share) {
    StaticLoad load = bent(arm);
    for (std::optional<double>& input : load.inputs) *input *= share;
    return load;
  };
  const auto tip_after = [&](double peak) {
    statics.begin_trial();
    double stamp_s = 0.0;
    for (int i = 0; i <= 40; ++i) {
      const double wave = i <= 20 ? peak * i / 20.0 : peak + (0.5 - peak) * (i - 20) / 20.0;
      EXPECT_EQ(statics.solve_next(stamp_s += 0.1, load_at(wave)), Outcome::kSolved);
    }
    return statics.point(0).p;
  };
  const Eigen::Vector3d from_below = tip_after(0.3), from_above = tip_after(1.2);
  EXPECT_GT((from_below - from_above).norm(), 5e-4);
  EXPECT_LT((tip_after(0.3) - from_below).norm(), 1e-9);  // begin_trial() forgets
  places_at(statics, arm, load_at(0.5));
  const Eigen::Vector3d alone = statics.point(0).p;
  places_at(statics, arm, load_at(1.2));
  places_at(statics, arm, load_at(0.5));
  EXPECT_EQ((statics.point(0).p - alone).norm(), 0.0);
}

TEST(ExtendedStatics, SaysWhereThereIsNone) {
  const arm::Arm arm = shipped("online_200mm");
  ExtendedStatics statics(arm, {usual("base_compliance")}, {});
  StaticLoad load = bent(arm);
  load.inputs[0].reset();
  EXPECT_EQ(statics.solve(load), Outcome::kNoLaws);
}

}  // namespace
}  // namespace softarm::model
