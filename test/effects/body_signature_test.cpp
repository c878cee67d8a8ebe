// What effects of body, boundary and load look like, as the catalogue says.
#include <gtest/gtest.h>

#include "effects/body_table.h"
#include "softarm/math/so3.h"
#include "softarm/rod/published.h"

namespace softarm::effects {
namespace {

using body_testing::Condition;
using body_testing::hanging;
using body_testing::horizontal;
using body_testing::standing;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

class Signatures : public ::testing::Test {
 protected:
  Present with(const char* id, std::initializer_list<double> values) const {
    return body_testing::present(id, body_testing::values_of(values));
  }
  /// Bodies moved, one column each, instant by instant.
  Matrix3Xd moved(const Present& by, const std::vector<Condition>& conditions) {
    return body_testing::moved(model, arm, by, body_testing::trial_of(arm, conditions));
  }
  Eigen::VectorXd inputs(double level, std::size_t first = 0) const {
    return body_testing::inputs_of(arm, level, first);
  }
  double tip(const Present& by, const Condition& condition) {
    return moved(by, {condition}).rightCols<1>().norm();
  }
  static constexpr Eigen::Index kRings = 4;
  const Arm arm = body_testing::shipped("online_200mm");
  ExtendedModel model{arm};
};

TEST_F(Signatures, StiffnessTaperMovesNothingWithoutLoadOrActuationAndGrowsWithLoad) {
  const Present taper = with("stiffness_taper", {0.2});
  EXPECT_LT(tip(taper, {inputs(0.0), 0.2, hanging()}), 1e-9);
  // Of an arm that sags little.
  Arm stiff = arm;
  stiff.segments[0].bending_stiffness.base_nm2 = 0.3;
  const Matrix3Xd sag = body_testing::moved(
      model, stiff, taper,
      body_testing::trial_of(stiff, {{inputs(0.0), 0.0, horizontal()}, {inputs(0.0), 0.1, horizontal()}}));
  EXPECT_GT(sag.col(3).x(), 1e-4) << "softer at the base: it hangs lower";
  EXPECT_GT(sag.col(7).x(), 1.5 * sag.col(3).x());
}

TEST_F(Signatures, ActuationTaperGrowsWithPressureAlone) {
  const Present taper = with("actuation_taper", {0.1});
  EXPECT_LT(tip(taper, {inputs(0.0), 0.1, horizontal()}), 1e-9);
  const double some = tip(taper, {inputs(0.3), 0.0, hanging()});
  EXPECT_NEAR(tip(taper, {inputs(0.6), 0.0, hanging()}) / some, 2.0, 0.2);
  // A tilt of the curvature: more at the base, less at the tip, the tip's tangent stays.
  const auto trial = body_testing::trial_of(arm, {{inputs(0.4), 0.0, hanging()}});
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  auto free = body_testing::trial_of(weightless, {{inputs(0.4), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, free),
             after = body_testing::predict(model, arm, {taper}, free);
  EXPECT_LT(before[0].q_tip.angularDistance(after[0].q_tip), 1e-9);
  EXPECT_LT(after[0].shape.middles.front().u.norm(), before[0].shape.middles.front().u.norm());
  EXPECT_GT(after[0].shape.middles.back().u.norm(), before[0].shape.middles.back().u.norm());
}

TEST_F(Signatures, SoftSpotKinksAtItsPlace) {
  const Condition loaded{inputs(0.5), 0.1, horizontal()};
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const Matrix3Xd at =
      body_testing::moved(model, arm, with("soft_spot", {0.3, 0.12, 0.03}),
                          body_testing::trial_of(weightless, {{inputs(0.5), 0.0, hanging()}}));
  // Nothing before it; beyond, about a turn about the place.
  EXPECT_LT(at.col(1).norm(), 0.05 * at.col(3).norm());
  EXPECT_GT(at.col(3).norm(), 1.8 * at.col(2).norm());
  EXPECT_GT(tip(with("soft_spot", {0.3, 0.03, 0.03}), loaded),
            tip(with("soft_spot", {0.3, 0.17, 0.03}), loaded))
      << "the moment is larger near the base";
}

TEST_F(Signatures, RigidEndsStayStraight) {
  const auto trial = body_testing::trial_of(arm, {{inputs(0.8), 0.1, hanging()}});
  const auto path = body_testing::predict(model, arm, {with("rigid_ends", {0.0335, 0.0335})}, trial);
  const auto& middles = path[0].shape.middles;
  for (const std::size_t j : {std::size_t{0}, std::size_t{1}, middles.size() - 2, middles.size() - 1})
    EXPECT_LT(middles[j].u.norm(), 0.02);
  EXPECT_GT(middles[5].u.norm(), 1.0);
}

TEST_F(Signatures, BaseTiltIsTheSameTurnAtEveryInput) {
  const Present tilt = with("base_tilt", {0.02, -0.01});
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial = body_testing::trial_of(
      weightless,
      {{inputs(0.0), 0.0, hanging()}, {inputs(0.5), 0.0, hanging()}, {inputs(1.0, 1), 0.0, standing()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {tilt}, trial);
  const Eigen::Matrix3d turn = exp_so3(Vector3d(0.01, 0.02, 0.0)).toRotationMatrix();
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LT((after[k].p - turn * before[k].p).norm(), 1e-9);
  // Towards x of the base frame.
  EXPECT_GT((after[0].p - before[0].p).col(3).x(), 0.0);
  EXPECT_LT((after[0].p - before[0].p).col(3).y(), 0.0);
}

TEST_F(Signatures, BaseComplianceTurnsWithTheLoad) {
  const Present yields = with("base_compliance", {0.2});
  EXPECT_LT(tip(yields, {inputs(0.0), 0.2, hanging()}), 1e-9);
  const auto trial = body_testing::trial_of(arm, {{inputs(0.0), 0.05, horizontal()}});
  const auto path = body_testing::predict(model, arm, {yields}, trial);
  // Moment of the weights about the clamp, x of the base frame down: the arm turns down there.
  const auto& shape = path[0].shape;
  EXPECT_NEAR(shape.base_moment_nm.y(), 0.2 * 9.80665 * 0.1 + 0.05 * 9.80665 * 0.2, 0.1);
  const Matrix3Xd first = moved(yields, {{inputs(0.0), 0.05, horizontal()}});
  EXPECT_NEAR(first(0, 0), 0.2 * shape.base_moment_nm.y() * 0.05, 3e-4);
}

TEST_F(Signatures, GravityDirectionSagsOffAndChangesSignWithTheMounting) {
  const Present off = with("gravity_direction", {0.0, 0.03});
  // y of the mocap frame: hanging (turned about x) that is -y of the base frame, standing +y.
  const Matrix3Xd hangs = moved(off, {{inputs(0.0), 0.1, hanging()}});
  EXPECT_LT(hangs.col(3).y(), -5e-4);
  const Matrix3Xd stands = moved(off, {{inputs(0.0), 0.0, standing()}});
  EXPECT_GT(stands.col(3).y(), 5e-4);
  // As the vector it says.
  const Values values = off.values;
  rod::Rod rod = model.rod().layout();
  Instant instant;
  instant.q_base_mocap = hanging().conjugate();
  rod.gravity_m_s2 = instant.q_base_mocap * arm.gravity_m_s2;
  off.effect->act(arm, model.rod(), values, instant, nullptr, {}, rod);
  const Vector3d expected =
      9.80665 * (hanging().conjugate() * Vector3d(0.0, std::sin(0.03), -std::cos(0.03)));
  EXPECT_LT((rod.gravity_m_s2 - expected).norm(), 1e-9);
}

TEST_F(Signatures, AxialComplianceStretchesWithPayload) {
  const Present soft = with("axial_compliance", {1.0 / 150.0});
  const Matrix3Xd light = moved(soft, {{inputs(0.0), 0.0, hanging()}});
  const Matrix3Xd heavy = moved(soft, {{inputs(0.0), 0.2, hanging()}});
  // N L / EA of the payload, and half of the weight.
  EXPECT_NEAR(light.col(3).z(), 0.2 * 0.5 * 0.2 * 9.80665 / 150.0, 1e-6);
  EXPECT_NEAR((heavy - light).col(3).z(), 0.2 * 0.2 * 9.80665 / 150.0, 1e-6);
}

TEST_F(Signatures, ShearSlopesUnderAForceAcross) {
  Arm stiff = arm;
  stiff.segments[0].bending_stiffness.base_nm2 = 0.5;
  const Matrix3Xd across =
      body_testing::moved(model, stiff, with("shear", {1.0 / 45.0}),
                          body_testing::trial_of(stiff, {{inputs(0.0), 0.1, horizontal()}}));
  // Force over GA: weight beyond the first ring's middle, and payload.
  EXPECT_NEAR(across(0, 0), 0.05 * 9.80665 * (0.1 + 0.175) / 45.0, 1e-4);
  EXPECT_LT(tip(with("shear", {1.0 / 45.0}), {inputs(0.0), 0.1, hanging()}), 1e-9);
}

TEST_F(Signatures, StrainStiffeningGrowsWithTheCubeOfTheBend) {
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const Present stiffer = with("strain_stiffening", {1e-3});
  const auto trial =
      body_testing::trial_of(weightless, {{inputs(0.3), 0.0, hanging()}, {inputs(0.6), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {stiffer}, trial);
  double lost[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const double linear = before[k].shape.middles[4].u.norm(), now = after[k].shape.middles[4].u.norm();
    EXPECT_NEAR(now * (1.0 + 1e-3 * now * now), linear, 1e-6 * linear);
    lost[k] = linear - now;
  }
  EXPECT_GT(lost[1], 6.0 * lost[0]);
}

TEST_F(Signatures, ContactDoesNothingBeforeItTouches) {
  const Present wall = with("contact", {50.0, 0.15, 0.0, 0.02});
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

TEST_F(Signatures, TetherPullsInProportionToTheTipsWay) {
  const Present hose = with("tether", {2.0, 0.0, 0.0});
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

TEST_F(Signatures, PayloadOffsetIsInProportionToThePayload) {
  const Present off = with("payload_offset", {0.0, 0.0, 0.02});
  EXPECT_LT(tip(off, {inputs(0.6), 0.0, hanging()}), 1e-9);
  const double light = tip(off, {inputs(0.6), 0.01, hanging()}),
               heavy = tip(off, {inputs(0.6), 0.02, hanging()});
  EXPECT_NEAR(heavy / light, 2.0, 0.2);
  // Along the axis of an arm that hangs straight it has no lever; across it has.
  EXPECT_LT(tip(off, {inputs(0.0), 0.2, hanging()}), 1e-9);
  EXPECT_GT(tip(with("payload_offset", {0.01, 0.0, 0.0}), {inputs(0.0), 0.2, hanging()}), 1e-3);
}

TEST_F(Signatures, TipMassIsAPayloadWhereThereIsNone) {
  const Matrix3Xd fitting = moved(with("tip_mass", {0.02}), {{inputs(0.3), 0.0, horizontal()}});
  const auto unloaded =
      body_testing::predict(model, arm, {}, body_testing::trial_of(arm, {{inputs(0.3), 0.0, horizontal()}}));
  const auto loaded =
      body_testing::predict(model, arm, {}, body_testing::trial_of(arm, {{inputs(0.3), 0.02, horizontal()}}));
  EXPECT_LT((fitting - (loaded[0].p - unloaded[0].p)).norm(), 1e-9);
  EXPECT_GT(fitting.norm(), 1e-3);
}

TEST_F(Signatures, MassDistributionKeepsTheWeight) {
  const auto trial = body_testing::trial_of(arm, {{inputs(0.0), 0.1, horizontal()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {with("mass_distribution", {0.3})}, trial);
  EXPECT_LT((after[0].shape.base_force_n - before[0].shape.base_force_n).norm(), 1e-9);
  EXPECT_GT((after[0].p - before[0].p).col(3).x(), 1e-3) << "heavier towards the tip: it hangs lower";
}

TEST_F(Signatures, PayloadScaleIsInProportionToThePayload) {
  const Present wrong = with("payload_scale", {0.05});
  EXPECT_EQ(tip(wrong, {inputs(0.5), 0.0, horizontal()}), 0.0);
  const auto said = body_testing::trial_of(arm, {{inputs(0.5), 0.105, horizontal()}});
  const auto hangs = body_testing::trial_of(arm, {{inputs(0.5), 0.1, horizontal()}});
  const auto a = body_testing::predict(model, arm, {wrong}, said),
             b = body_testing::predict(model, arm, {}, hangs);
  EXPECT_LT((a[0].p - b[0].p).norm(), 1e-12);
}

TEST_F(Signatures, TorsionTurnsWhatLiesAcrossThePlane) {
  // Bent towards y, loaded along x: the tip's load winds the arm.
  const auto bent = inputs(0.8, 1);
  EXPECT_GT(tip(with("torsion", {50.0, 0.0}), {bent, 0.05, horizontal()}), 1e-3);
  // In one plane there is no twist.
  EXPECT_LT(tip(with("torsion", {50.0, 0.0}), {inputs(0.0), 0.05, horizontal()}), 1e-9);
  // With pressure: by so much at 50 kPa of mean pressure, over the whole arm.
  Eigen::VectorXd even = Eigen::VectorXd::Constant(3, 25e3);
  const auto trial = body_testing::trial_of(arm, {{even, 0.0, hanging()}});
  const auto path = body_testing::predict(model, arm, {with("torsion", {0.0, 0.08})}, trial);
  double twist = 0.0;
  for (std::size_t j = 0; j < path[0].shape.middles.size(); ++j) {
    const double length =
        (path[0].shape.stations[j].p - (j > 0 ? path[0].shape.stations[j - 1].p : Vector3d(Vector3d::Zero())))
            .norm();
    twist += path[0].shape.middles[j].u.z() * length;
  }
  EXPECT_NEAR(twist, 0.04, 2e-4);
}

TEST_F(Signatures, RestCurvatureIsThereWithoutInput) {
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial = body_testing::trial_of(weightless, {{inputs(0.0), 0.0, hanging()}});
  const auto path = body_testing::predict(model, arm, {with("rest_curvature", {0.3, -0.2, 0.0})}, trial);
  // A circle: w = k s^2 / 2.
  EXPECT_NEAR(path[0].p(0, 3), 0.3 * 0.02, 1e-5);
  EXPECT_NEAR(path[0].p(1, 3), -0.2 * 0.02, 1e-5);
  Arm two = body_testing::shipped("two_segment");
  ExtendedModel of_two(two);
  two.gravity_m_s2.setZero();
  const auto straight = body_testing::trial_of(two, {{body_testing::inputs_of(two, 0.0), 0.0, hanging()}});
  const auto second = body_testing::predict(of_two, two, {with("rest_curvature", {0.5, 0.0, 2.0})}, straight);
  const auto& middles = second[0].shape.middles;
  EXPECT_NEAR(middles.front().u.norm(), 0.0, 1e-9);
  EXPECT_NEAR(middles.back().u.y(), 0.5, 1e-9);
  EXPECT_EQ(find("rest_curvature")->grid(two, of_two.rod()).size(), 3u);
}

TEST_F(Signatures, BendingPlaneOffsetTurnsTheDeflection) {
  Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial =
      body_testing::trial_of(weightless, {{inputs(0.3), 0.0, hanging()}, {inputs(0.9, 2), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {with("bending_plane_offset", {0.09})}, trial);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.09, Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t k = 0; k < 2; ++k) EXPECT_LT((after[k].p - turn * before[k].p).norm(), 1e-9);
}

TEST_F(Signatures, MarkerSlipMovesOneRingByTheSameInItsOwnFrame) {
  const Matrix3Xd slip = moved(with("marker_slip", {0.0, 0.0, 2e-3, 3.0}),
                               {{inputs(0.0), 0.0, hanging()}, {inputs(0.9), 0.1, hanging()}});
  for (Eigen::Index c = 0; c < slip.cols(); ++c)
    EXPECT_NEAR(slip.col(c).norm(), c % kRings == 2 ? 2e-3 : 0.0, 1e-12);
  EXPECT_LT((slip.col(2) - Vector3d(0.0, 0.0, 2e-3)).norm(), 1e-12);
  EXPECT_LT(slip.col(6).z(), 1.98e-3) << "it turns with the arm";
}

TEST_F(Signatures, InertiaActsOnlyOnWhatAccelerates) {
  const auto swing = body_testing::trial_of(arm, body_testing::swinging(arm), true);
  const Dynamics none{false, 0.0};
  const Present moves = with("inertia", {1.0, 0.0}), lags = with("inertia", {0.0, 0.03});
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

TEST_F(Signatures, PublishedLoadLawIsTheOneThatThePapersPrint) {
  Arm bending = arm;
  bending.segments[0].bending_stiffness = {};
  bending.segments[0].bending_stiffness.base_nm2 = 0.038;
  for (Chamber& chamber : bending.segments[0].chambers) chamber.near_elongation_m_per_pa = 0.0;
  ExtendedModel standing_arm(bending);
  Eigen::VectorXd one = Eigen::VectorXd::Zero(3);
  one[0] = 0.2 / bending.segments[0].chambers[0].moment_gain_nm_per_pa;
  for (const double payload : {0.0, 0.1}) {
    rod::PublishedArm printed;
    printed.moment_nm = 0.2;
    printed.bending_stiffness_nm2 = 0.038;
    printed.length_m = 0.2;
    printed.payload_n = payload * 9.80665;
    printed.weight_n = 0.2 * 9.80665;
    rod::PublishedOptions fine;
    fine.nodes = 401;
    fine.relaxation = rod::settling_relaxation(printed);
    const auto trial = body_testing::trial_of(bending, {{one, payload, standing()}});
    for (const bool as_printed : {false, true}) {
      const auto expected =
          rod::solve_published(printed, as_printed ? rod::LoadLaw::kPrinted : rod::LoadLaw::kStatics, fine);
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
