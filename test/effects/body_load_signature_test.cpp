// What effects of boundary and load look like, as the catalogue says.
#include <gtest/gtest.h>

#include "body_signatures.h"
#include "math/so3.h"
#include "published/published.h"

namespace softarm::effects {
namespace {

using body_testing::Condition;
using body_testing::hanging;
using body_testing::horizontal;
using body_testing::standing;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

class LoadSignatures : public body_testing::Signatures {};

TEST_F(LoadSignatures, BaseTiltIsTheSameTurnAtEveryInput) {
  const model::Present tilt = with("base_tilt", {0.02, -0.01});
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial = body_testing::trial_of(
      weightless,
      {{inputs(0.0), 0.0, hanging()}, {inputs(0.5), 0.0, hanging()}, {inputs(1.0, 1), 0.0, standing()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {tilt}, trial);
  const Eigen::Matrix3d turn = math::exp_so3(Vector3d(0.01, 0.02, 0.0)).toRotationMatrix();
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LT((after[k].p - turn * before[k].p).norm(), 1e-9);
  // Towards x of the base frame.
  EXPECT_GT((after[0].p - before[0].p).col(3).x(), 0.0);
  EXPECT_LT((after[0].p - before[0].p).col(3).y(), 0.0);
}

TEST_F(LoadSignatures, BaseComplianceTurnsWithTheLoad) {
  const model::Present yields = with("base_compliance", {0.2});
  EXPECT_LT(tip(yields, {inputs(0.0), 0.2, hanging()}), 1e-9);
  const auto trial = body_testing::trial_of(arm, {{inputs(0.0), 0.05, horizontal()}});
  const auto path = body_testing::predict(model, arm, {yields}, trial);
  // Moment of the weights about the clamp, x of the base frame down: the arm turns down there.
  const auto& shape = path[0].shape;
  EXPECT_NEAR(shape.base_moment_nm.y(), 0.2 * 9.80665 * 0.1 + 0.05 * 9.80665 * 0.2, 0.1);
  const Matrix3Xd first = moved(yields, {{inputs(0.0), 0.05, horizontal()}});
  EXPECT_NEAR(first(0, 0), 0.2 * shape.base_moment_nm.y() * 0.05, 3e-4);
}

TEST_F(LoadSignatures, GravityDirectionSagsOffAndChangesSignWithTheMounting) {
  const model::Present off = with("gravity_direction", {0.0, 0.03});
  // y of the mocap frame: hanging (turned about x) that is -y of the base frame, standing +y.
  const Matrix3Xd hangs = moved(off, {{inputs(0.0), 0.1, hanging()}});
  EXPECT_LT(hangs.col(3).y(), -5e-4);
  const Matrix3Xd stands = moved(off, {{inputs(0.0), 0.0, standing()}});
  EXPECT_GT(stands.col(3).y(), 5e-4);
  // As the vector it says.
  const model::Values values = off.values;
  rod::Rod rod = model.rod().layout();
  model::Instant instant;
  instant.q_base_mocap = hanging().conjugate();
  rod.gravity_m_s2 = instant.q_base_mocap * arm.gravity_m_s2;
  off.effect->act(arm, model.rod(), values, instant, nullptr, {}, rod);
  const Vector3d expected =
      9.80665 * (hanging().conjugate() * Vector3d(0.0, std::sin(0.03), -std::cos(0.03)));
  EXPECT_LT((rod.gravity_m_s2 - expected).norm(), 1e-9);
}

TEST_F(LoadSignatures, WhatIsSomewhereAlongTheArmSaysWhere) {
  const auto place = [this](const model::Present& present) {
    return present.effect->place(arm, present.values).value();
  };
  EXPECT_EQ(place(with("contact", {50.0, 0.15, 0.0, 0.02, 0.0, 0.0, 0.0})), (std::pair{0.15, 0.15}));
  const auto [begin_m, end_m] = place(with("contact", {50.0, 0.15, 0.0, 0.02, 0.0, 0.0, 0.08}));
  EXPECT_NEAR(begin_m, 0.07, 1e-12);
  EXPECT_EQ(end_m, 0.2);
  const auto [from_m, to_m] = place(with("soft_spot", {0.3, 0.1, 0.04}));
  EXPECT_NEAR(from_m, 0.08, 1e-12);
  EXPECT_NEAR(to_m, 0.12, 1e-12);
  EXPECT_EQ(place(with("soft_spot", {0.3, 0.01, 0.04})).first, 0.0);  // no further than the arm
}

TEST_F(LoadSignatures, ContactDoesNothingBeforeItTouches) {
  const model::Present wall = with("contact", {50.0, 0.15, 0.0, 0.02, 0.0, 0.0, 0.0});
  double last = 0.0;
  bool touched = false, free = false;
  for (const double level : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    const Condition condition{inputs(level), 0.0, hanging()};
    const auto alone = body_testing::predict(model, arm, {}, body_testing::trial_of(arm, {condition}));
    const double by = tip(wall, condition);
    if (alone[0].p.col(2).x() < 0.02) {
      EXPECT_LT(by, 1e-9) << level;
      free = true;
    } else {
      EXPECT_GT(by, last) << level;
      touched = true;
      last = by;
    }
  }
  EXPECT_TRUE(touched && free);
  EXPECT_GT(last, 2e-3);
}

TEST_F(LoadSignatures, ARoundPostPushesAwayFromItsAxis) {
  const double stiffness = 40.0, distance = 0.02, radius = 0.015;
  const model::Present post = with("contact", {stiffness, 0.15, 0.4, distance, 0.0, 1.0 / radius, 0.0});
  const Vector3d axis = (distance + radius) * Vector3d(std::cos(0.4), std::sin(0.4), 0.0);
  const auto force = [&](const model::Present& of, const Vector3d& at) {
    return of.effect->holding_force_n(model.rod(), of.values, 0, at, {});
  };
  for (const Vector3d& at :
       {Vector3d(0.022, 0.005, 0.1), Vector3d(0.02, 0.018, 0.12), Vector3d(0.035, 0.02, 0.1),
        Vector3d(0.045, 0.0, 0.1), Vector3d(0.0, 0.03, 0.1)}) {
    const Vector3d out(at.x() - axis.x(), at.y() - axis.y(), 0.0);
    const double depth = radius - out.norm();
    const Vector3d expected = depth > 0.0 ? Vector3d(stiffness * depth * out.normalized()) : Vector3d::Zero();
    EXPECT_LT((force(post, at) - expected).norm(), 1e-12) << at.transpose();
  }
  const model::Present wall = with("contact", {stiffness, 0.15, 0.4, distance, 0.0, 0.0, 0.0});
  const Vector3d beside(0.045, 0.0, 0.1);
  EXPECT_GT(force(wall, beside).norm(), 0.1);
  EXPECT_EQ(force(post, beside).norm(), 0.0) << "the arm passes it";
  // One of a kilometre is a wall.
  const model::Present wide = with("contact", {stiffness, 0.15, 0.4, distance, 0.0, 1e-3, 0.0});
  const Vector3d deep(0.02, 0.03, 0.1);
  ASSERT_GT(force(wall, deep).norm(), 0.1);
  EXPECT_LT((force(wide, deep) - force(wall, deep)).norm(), 1e-4);
}

TEST_F(LoadSignatures, ARoughWallHoldsTheArmWhereItTouchesAndLetsItSlip) {
  // Pressed against a wall towards x by the first chamber, drawn along it to and fro by the other two.
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const double most_pa = 3e4, friction = 0.3, stiffness = 100.0;
  std::vector<Condition> conditions;
  for (int i = 0; i <= 80; ++i) {
    Eigen::VectorXd u(3);
    const double across = i < 10 ? 0.0 : std::sin(2.0 * M_PI * (i - 10) / 36.0);
    u << most_pa * std::min(1.0, i / 10.0), 0.3 * most_pa * std::max(0.0, across),
        0.3 * most_pa * std::max(0.0, -across);
    conditions.push_back({u, 0.0, hanging()});
  }
  const auto trial = body_testing::trial_of(weightless, conditions, true);
  const auto y_of = [&](double mu) {
    std::vector<double> y;
    for (const auto& now : body_testing::predict(
             model, arm, {with("contact", {stiffness, 0.15, 0.0, 0.02, mu, 0.0, 0.0})}, trial))
      y.push_back(now.p(1, 2));
    return y;
  };
  const std::vector<double> smooth = y_of(0.0), rough = y_of(friction), rougher = y_of(2.0);
  // A loop: at the same pressures, the arm lags behind to either side. 46 and 64 are half a period apart.
  const auto loop = [](const std::vector<double>& y) { return std::abs(y[64] - y[46]); };
  EXPECT_LT(loop(smooth), 1e-6);
  EXPECT_GT(loop(rough), 3e-4);
  const auto range = [](const std::vector<double>& y) {
    return *std::max_element(y.begin() + 20, y.end()) - *std::min_element(y.begin() + 20, y.end());
  };
  EXPECT_LT(range(rough), 0.98 * range(smooth));
  EXPECT_LT(range(rougher), 0.9 * range(rough)) << "one that never slips is a spring";
  EXPECT_LT(loop(rougher), loop(rough));
}

TEST_F(LoadSignatures, TetherPullsInProportionToTheTipsWay) {
  const model::Present hose = with("tether", {2.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_LT(tip(hose, {inputs(0.0), 0.1, hanging()}), 1e-9);
  const auto trial = body_testing::trial_of(arm, {{inputs(0.5), 0.1, hanging()}});
  const auto path = body_testing::predict(model, arm, {hose}, trial);
  const Vector3d tip_p = path[0].shape.stations.back().p;
  const rod::Rod& layout = model.rod().layout();
  const Vector3d weight = 0.1 * trial.blocks[0].gravity_base;
  EXPECT_LT(
      (path[0].shape.stations.back().n - weight - 2.0 * (Vector3d(0.0, 0.0, layout.rest_length_m()) - tip_p))
          .norm(),
      1e-4);
}

TEST_F(LoadSignatures, AHoseThatGrowsTautAndAWallDoNearlyTheSame) {
  const model::Present wall = with("contact", {60.0, 0.2, 0.3, 0.02, 0.0, 0.0, 0.0});
  model::Present hose = with("tether", {0.0, 0.0, 0.0, 0.0, 0.0});
  const auto as_hose = hose.effect->like(*wall.effect, wall.values, model.rod());
  ASSERT_TRUE(as_hose);
  hose.values = *as_hose;
  for (const double level : {0.2, 0.5, 0.8}) {
    const Condition condition{inputs(level), 0.0, hanging()};
    const Matrix3Xd by_wall = moved(wall, {condition});
    EXPECT_LT((moved(hose, {condition}) - by_wall).norm(), 0.25 * by_wall.norm() + 1e-9) << level;
  }
  EXPECT_GT(tip(wall, {inputs(0.8), 0.0, hanging()}), 5e-3);
  // And back again.
  const auto as_wall = wall.effect->like(*hose.effect, hose.values, model.rod());
  ASSERT_TRUE(as_wall);
  EXPECT_LT((*as_wall - wall.values).norm(), 1e-9);
  // Anchors are no further aside than their range.
  arm::Arm longer = arm;
  longer.segments[0].length_m = 1.5;
  const auto of_longer = hose.effect->like(*wall.effect, wall.values, model::FineRod(longer));
  ASSERT_TRUE(of_longer);
  EXPECT_NEAR((*of_longer)[4], 1.02, 1e-9);
  EXPECT_NEAR(std::hypot((*of_longer)[2], (*of_longer)[3]), 1.0, 1e-9);
  EXPECT_FALSE(
      wall.effect->like(*with("tip_mass", {0.1}).effect, body_testing::values_of({0.1}), model.rod()));
}

TEST_F(LoadSignatures, AWallAlongAStretchAndOneThatTouchesAtOnePlaceDoNearlyTheSame) {
  const model::Present at_one = with("contact", {60.0, 0.17, 0.3, 0.02, 0.4, 3.0, 0.0});
  model::Present spread = at_one;
  const auto as_spread = spread.effect->like(*at_one.effect, at_one.values, model.rod());
  ASSERT_TRUE(as_spread);
  spread.values = *as_spread;
  EXPECT_EQ(spread.values.segment<4>(2), at_one.values.segment<4>(2));
  const auto [from_m, to_m] = *spread.effect->place(arm, spread.values);
  EXPECT_GT(to_m - from_m, 0.5 * arm.total_length_m());
  for (const double level : {0.8, 1.0}) {
    const Condition condition{inputs(level), 0.0, hanging()};
    const Matrix3Xd by_one = moved(at_one, {condition});
    EXPECT_GT(by_one.norm(), 1e-3) << level;
    EXPECT_LT((moved(spread, {condition}) - by_one).norm(), 0.5 * by_one.norm()) << level;
  }
  // And back again.
  const auto again = at_one.effect->like(*spread.effect, spread.values, model.rod());
  ASSERT_TRUE(again);
  EXPECT_EQ((*again)[6], 0.0);
  EXPECT_NEAR((*again)[0], at_one.values[0], 1e-9);
  EXPECT_GT((*again)[1], from_m);
  EXPECT_LT((*again)[1], to_m);
}

TEST_F(LoadSignatures, PayloadOffsetIsInProportionToThePayload) {
  const model::Present off = with("payload_offset", {0.0, 0.0, 0.02});
  EXPECT_LT(tip(off, {inputs(0.6), 0.0, hanging()}), 1e-9);
  const double light = tip(off, {inputs(0.6), 0.01, hanging()}),
               heavy = tip(off, {inputs(0.6), 0.02, hanging()});
  EXPECT_NEAR(heavy / light, 2.0, 0.2);
  // Along the axis of an arm that hangs straight it has no lever; across it has.
  EXPECT_LT(tip(off, {inputs(0.0), 0.2, hanging()}), 1e-9);
  EXPECT_GT(tip(with("payload_offset", {0.01, 0.0, 0.0}), {inputs(0.0), 0.2, hanging()}), 1e-3);
}

TEST_F(LoadSignatures, TipMassIsAPayloadWhereThereIsNone) {
  const Matrix3Xd fitting = moved(with("tip_mass", {0.02}), {{inputs(0.3), 0.0, horizontal()}});
  const auto unloaded =
      body_testing::predict(model, arm, {}, body_testing::trial_of(arm, {{inputs(0.3), 0.0, horizontal()}}));
  const auto loaded =
      body_testing::predict(model, arm, {}, body_testing::trial_of(arm, {{inputs(0.3), 0.02, horizontal()}}));
  EXPECT_LT((fitting - (loaded[0].p - unloaded[0].p)).norm(), 1e-9);
  EXPECT_GT(fitting.norm(), 1e-3);
}

TEST_F(LoadSignatures, MassDistributionKeepsTheWeight) {
  const auto trial = body_testing::trial_of(arm, {{inputs(0.0), 0.1, horizontal()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {with("mass_distribution", {0.3})}, trial);
  EXPECT_LT((after[0].shape.base_force_n - before[0].shape.base_force_n).norm(), 1e-9);
  EXPECT_GT((after[0].p - before[0].p).col(3).x(), 1e-3) << "heavier towards the tip: it hangs lower";
}

TEST_F(LoadSignatures, PayloadScaleIsInProportionToThePayload) {
  const model::Present wrong = with("payload_scale", {0.05});
  EXPECT_EQ(tip(wrong, {inputs(0.5), 0.0, horizontal()}), 0.0);
  const auto said = body_testing::trial_of(arm, {{inputs(0.5), 0.105, horizontal()}});
  const auto hangs = body_testing::trial_of(arm, {{inputs(0.5), 0.1, horizontal()}});
  const auto a = body_testing::predict(model, arm, {wrong}, said),
             b = body_testing::predict(model, arm, {}, hangs);
  EXPECT_LT((a[0].p - b[0].p).norm(), 1e-12);
}

TEST_F(LoadSignatures, InertiaActsOnlyOnWhatAccelerates) {
  const auto swing = body_testing::trial_of(arm, body_testing::swinging(arm), true);
  const model::Dynamics none{false, 0.0};
  const model::Present moves = with("inertia", {1.0, 0.0}), lags = with("inertia", {0.0, 0.03});
  // As much again as the known masses is what these alone do, and the wall's delay the wall's delay.
  const auto beside = body_testing::predict(model, arm, {moves}, swing, none);
  const auto known = body_testing::predict(model, arm, {}, swing, {true, 0.0});
  EXPECT_LT((body_testing::stacked(beside) - body_testing::stacked(known)).lpNorm<Eigen::Infinity>(), 1e-6);
  const auto late = body_testing::predict(model, arm, {lags}, swing, none);
  const auto wall = body_testing::predict(model, arm, {}, swing, {false, 0.03});
  EXPECT_LT((body_testing::stacked(late) - body_testing::stacked(wall)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_GT((body_testing::stacked(late) - body_testing::stacked(known)).lpNorm<Eigen::Infinity>(), 1e-4);
  const std::vector<Condition> still(6, Condition{inputs(0.7), 0.1, hanging()});
  const auto held = body_testing::trial_of(arm, still, true);
  EXPECT_LT((body_testing::stacked(body_testing::predict(model, arm, {moves}, held)) -
             body_testing::stacked(body_testing::predict(model, arm, {}, held)))
                .lpNorm<Eigen::Infinity>(),
            1e-9);
}

TEST_F(LoadSignatures, PublishedLoadLawIsTheOneThatThePapersPrint) {
  arm::Arm bending = arm;
  bending.segments[0].bending_stiffness = {};
  bending.segments[0].bending_stiffness.base_nm2 = 0.038;
  for (arm::Chamber& chamber : bending.segments[0].chambers) chamber.near_elongation_m_per_pa = 0.0;
  model::ExtendedModel standing_arm(bending);
  Eigen::VectorXd one = Eigen::VectorXd::Zero(3);
  one[0] = 0.2 / bending.segments[0].chambers[0].moment_gain_nm_per_pa;
  for (const double payload : {0.0, 0.1}) {
    published::PublishedArm printed;
    printed.moment_nm = 0.2;
    printed.bending_stiffness_nm2 = 0.038;
    printed.length_m = 0.2;
    printed.payload_n = payload * 9.80665;
    printed.weight_n = 0.2 * 9.80665;
    published::PublishedOptions fine;
    fine.nodes = 401;
    fine.relaxation = published::settling_relaxation(printed);
    const auto trial = body_testing::trial_of(bending, {{one, payload, standing()}});
    for (const bool as_printed : {false, true}) {
      const auto expected = published::solve_published(
          printed, as_printed ? published::LoadLaw::kPrinted : published::LoadLaw::kStatics, fine);
      ASSERT_EQ(expected.status, rod::SolveStatus::kConverged);
      const auto path = body_testing::predict(standing_arm, bending,
                                              {with("published_load_law", {as_printed ? 1.0 : 0.0})}, trial);
      EXPECT_LT((path[0].p.col(3) - expected.p_m.col(400)).norm(), as_printed ? 2e-4 : 2e-6);
      EXPECT_LT((path[0].p.col(1) - expected.p_m.col(200)).norm(), as_printed ? 2e-4 : 2e-6);
    }
    EXPECT_GT(body_testing::moved(standing_arm, bending, with("published_load_law", {1.0}), trial)
                  .rightCols<1>()
                  .norm(),
              2e-3);
  }
}

}  // namespace
}  // namespace softarm::effects
