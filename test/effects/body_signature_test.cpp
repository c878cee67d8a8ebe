// What effects of the body look like, as the catalogue says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "body_signatures.h"

namespace softarm::effects {
namespace {

using body_testing::Condition;
using body_testing::hanging;
using body_testing::horizontal;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

class BodySignatures : public body_testing::Signatures {};

TEST_F(BodySignatures, StiffnessTaperMovesNothingWithoutLoadOrActuationAndGrowsWithLoad) {
  const model::Present taper = with("stiffness_taper", {0.2});
  EXPECT_LT(tip(taper, {inputs(0.0), 0.2, hanging()}), 1e-9);
  // Of an arm that sags little.
  arm::Arm stiff = arm;
  stiff.segments[0].bending_stiffness.base_nm2 = 0.3;
  const Matrix3Xd sag = body_testing::moved(
      model, stiff, taper,
      body_testing::trial_of(stiff, {{inputs(0.0), 0.0, horizontal()}, {inputs(0.0), 0.1, horizontal()}}));
  EXPECT_GT(sag.col(3).x(), 1e-4) << "softer at the base: it hangs lower";
  EXPECT_GT(sag.col(7).x(), 1.5 * sag.col(3).x());
}

TEST_F(BodySignatures, ActuationTaperGrowsWithPressureAlone) {
  const model::Present taper = with("actuation_taper", {0.1});
  EXPECT_LT(tip(taper, {inputs(0.0), 0.1, horizontal()}), 1e-9);
  const double some = tip(taper, {inputs(0.3), 0.0, hanging()});
  EXPECT_NEAR(tip(taper, {inputs(0.6), 0.0, hanging()}) / some, 2.0, 0.2);
  // A tilt of the curvature: more at the base, less at the tip, the tip's tangent stays.
  const auto trial = body_testing::trial_of(arm, {{inputs(0.4), 0.0, hanging()}});
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  auto free = body_testing::trial_of(weightless, {{inputs(0.4), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, free),
             after = body_testing::predict(model, arm, {taper}, free);
  EXPECT_LT(before[0].q_tip.angularDistance(after[0].q_tip), 1e-9);
  EXPECT_LT(after[0].shape.middles.front().u.norm(), before[0].shape.middles.front().u.norm());
  EXPECT_GT(after[0].shape.middles.back().u.norm(), before[0].shape.middles.back().u.norm());
}

TEST_F(BodySignatures, SoftSpotKinksAtItsPlace) {
  const Condition loaded{inputs(0.5), 0.1, horizontal()};
  arm::Arm weightless = arm;
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

TEST_F(BodySignatures, RigidEndsStayStraight) {
  const auto trial = body_testing::trial_of(arm, {{inputs(0.8), 0.1, hanging()}});
  const auto path = body_testing::predict(model, arm, {with("rigid_ends", {0.0335, 0.0335})}, trial);
  const auto& middles = path[0].shape.middles;
  for (const std::size_t j : {std::size_t{0}, std::size_t{1}, middles.size() - 2, middles.size() - 1})
    EXPECT_LT(middles[j].u.norm(), 0.02);
  EXPECT_GT(middles[5].u.norm(), 1.0);
}

TEST_F(BodySignatures, AxialComplianceStretchesWithPayload) {
  const model::Present soft = with("axial_compliance", {1.0 / 150.0});
  const Matrix3Xd light = moved(soft, {{inputs(0.0), 0.0, hanging()}});
  const Matrix3Xd heavy = moved(soft, {{inputs(0.0), 0.2, hanging()}});
  // N L / EA of the payload, and half of the weight.
  EXPECT_NEAR(light.col(3).z(), 0.2 * 0.5 * 0.2 * 9.80665 / 150.0, 1e-6);
  EXPECT_NEAR((heavy - light).col(3).z(), 0.2 * 0.2 * 9.80665 / 150.0, 1e-6);
}

TEST_F(BodySignatures, ShearSlopesUnderAForceAcross) {
  arm::Arm stiff = arm;
  stiff.segments[0].bending_stiffness.base_nm2 = 0.5;
  const Matrix3Xd across =
      body_testing::moved(model, stiff, with("shear", {1.0 / 45.0}),
                          body_testing::trial_of(stiff, {{inputs(0.0), 0.1, horizontal()}}));
  // Force over GA: weight beyond the first ring's middle, and payload.
  EXPECT_NEAR(across(0, 0), 0.05 * 9.80665 * (0.1 + 0.175) / 45.0, 1e-4);
  EXPECT_LT(tip(with("shear", {1.0 / 45.0}), {inputs(0.0), 0.1, hanging()}), 1e-9);
}

TEST_F(BodySignatures, StrainStiffeningGrowsWithTheCubeOfTheBend) {
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const model::Present stiffer = with("strain_stiffening", {1e-3});
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

TEST_F(BodySignatures, StiffnessByTheDirectionOfBending) {
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const double a = 0.2, c = -0.1, softer = 0.3, side = 0.4;
  for (const std::size_t chamber : {0u, 1u, 2u}) {
    const auto trial = body_testing::trial_of(weightless, {{inputs(0.5, chamber), 0.0, hanging()}});
    const auto bent_of = [&](const std::vector<model::Present>& effects) {
      const Vector3d u = body_testing::predict(model, arm, effects, trial)[0].shape.middles[4].u;
      return Eigen::Vector2d(u.y(), -u.x());  // towards x and y
    };
    const Eigen::Vector2d even = bent_of({});
    // M = EI (I + T) u of a plane; the moment is that of the even arm.
    Eigen::Matrix2d plane;
    plane << 1.0 + a, c, c, 1.0 - a;
    EXPECT_LT((plane * bent_of({with("plane_stiffness", {a, c})}) - even).norm(), 1e-5 * even.norm());
    // Towards the side it is softer, across it and away from it as it was.
    const Eigen::Vector2d to_side(std::cos(side), std::sin(side));
    const Eigen::Vector2d bent_to_side = bent_of({with("one_sided_softness", {softer, side})});
    EXPECT_LT((bent_to_side - softer * std::max(0.0, to_side.dot(bent_to_side)) * to_side - even).norm(),
              1e-5 * even.norm());
    // M0 (1 + share |u| / 5) = EI |u|.
    const double bent = bent_of({with("curvature_gain", {0.1})}).norm();
    EXPECT_NEAR(bent / (1.0 + 0.1 * bent / 5.0), even.norm(), 1e-5 * even.norm());
  }
}

TEST_F(BodySignatures, TorsionTurnsWhatLiesAcrossThePlane) {
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

TEST_F(BodySignatures, RestCurvatureIsThereWithoutInput) {
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial = body_testing::trial_of(weightless, {{inputs(0.0), 0.0, hanging()}});
  const auto path = body_testing::predict(model, arm, {with("rest_curvature", {0.3, -0.2, 0.0})}, trial);
  // A circle: w = k s^2 / 2.
  EXPECT_NEAR(path[0].p(0, 3), 0.3 * 0.02, 1e-5);
  EXPECT_NEAR(path[0].p(1, 3), -0.2 * 0.02, 1e-5);
  arm::Arm two = body_testing::shipped("two_segment");
  model::ExtendedModel of_two(two);
  two.gravity_m_s2.setZero();
  const auto straight = body_testing::trial_of(two, {{body_testing::inputs_of(two, 0.0), 0.0, hanging()}});
  const auto second = body_testing::predict(of_two, two, {with("rest_curvature", {0.5, 0.0, 2.0})}, straight);
  const auto& middles = second[0].shape.middles;
  EXPECT_NEAR(middles.front().u.norm(), 0.0, 1e-9);
  EXPECT_NEAR(middles.back().u.y(), 0.5, 1e-9);
  EXPECT_EQ(find("rest_curvature")->grid(two, of_two.rod()).size(), 3u);
}

TEST_F(BodySignatures, BendingPlaneOffsetTurnsTheDeflection) {
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial =
      body_testing::trial_of(weightless, {{inputs(0.3), 0.0, hanging()}, {inputs(0.9, 2), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto after = body_testing::predict(model, arm, {with("bending_plane_offset", {0.09})}, trial);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.09, Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t k = 0; k < 2; ++k) EXPECT_LT((after[k].p - turn * before[k].p).norm(), 1e-9);
}

TEST_F(BodySignatures, ASkinSlidesWithTheCurvatureUnderIt) {
  arm::Arm weightless = arm;
  weightless.gravity_m_s2.setZero();
  const auto trial =
      body_testing::trial_of(weightless, {{inputs(0.3), 0.0, hanging()}, {inputs(0.9, 2), 0.0, hanging()}});
  const auto before = body_testing::predict(model, arm, {}, trial);
  const auto all = body_testing::predict(model, arm, {with("skin_marker", {2e-4, 0.0, 0.0, 0.0})}, trial);
  const auto third = body_testing::predict(model, arm, {with("skin_marker", {0.0, 2e-4, -1e-4, 3.0})}, trial);
  for (std::size_t k = 0; k < 2; ++k) {
    // The arm is an arc: its curvature is the same everywhere, and at the ring's own section.
    const rod::RodState& section = before[k].shape.stations[8];
    const Eigen::Vector2d bent(section.u.y(), -section.u.x());
    ASSERT_GT(bent.norm(), 0.3);
    for (Eigen::Index b = 0; b < kRings; ++b) {
      const Vector3d moved = all[k].p.col(b) - before[k].p.col(b);
      EXPECT_NEAR(moved.norm(), 2e-4 * bent.norm(), 1e-7);
      // To the inside: the arc's centre is there.
      if (b + 1 < kRings) {
        EXPECT_GT(moved.dot(before[k].p.col(3) - before[k].p.col(b)), 0.0);
      }
      const Vector3d slid = third[k].p.col(b) - before[k].p.col(b);
      EXPECT_NEAR(slid.norm(), b == 2 ? std::abs(2e-4 * bent.x() - 1e-4 * bent.y()) : 0.0, 1e-7);
    }
  }
  // Bent twice as far it moves twice as far: marker_slip would not move.
  EXPECT_GT((all[1].p - before[1].p).norm(), 1.5 * (all[0].p - before[0].p).norm());
  EXPECT_EQ(find("skin_marker")->grid(arm, model.rod()).size(), arm.bodies.size() + 1);
}

TEST_F(BodySignatures, AWrongScaleStretchesFromTheBaseWhereThatIsMeasured) {
  const auto trial = body_testing::trial_of(arm, {{inputs(0.7), 0.05, horizontal()}});
  arm::Arm measured = arm;
  measured.base.body = "base";
  measured.base.rod_in_body = Eigen::Translation3d(0.0, 0.0, 0.03);
  arm::Arm fixed = arm;
  fixed.base.body.reset();
  const auto before = body_testing::predict(model, arm, {}, trial);
  const Matrix3Xd of_measured =
      body_testing::moved(model, measured, with("camera_scale", {0.01, 0.0, 0.0}), trial);
  const Matrix3Xd of_fixed = body_testing::moved(model, fixed, with("camera_scale", {0.01, 0.0, 0.0}), trial);
  const Vector3d base_in_mocap(0.3, -0.2, 1.0);
  for (Eigen::Index b = 0; b < kRings; ++b) {
    EXPECT_LT((of_measured.col(b) - 0.01 * (before[0].p.col(b) + Vector3d(0.0, 0.0, 0.03))).norm(), 1e-12);
    EXPECT_LT(
        (of_fixed.col(b) - 0.01 * (before[0].p.col(b) + horizontal().conjugate() * base_in_mocap)).norm(),
        1e-12);
  }
}

TEST_F(BodySignatures, AScaleOfHeightsStretchesAgainstGravityHoweverTheArmHangs) {
  for (const Eigen::Quaterniond& mounting : {hanging(), horizontal()}) {
    const auto trial = body_testing::trial_of(arm, {{inputs(0.7), 0.05, mounting}});
    arm::Arm measured = arm;
    measured.base.body = "base";
    measured.base.rod_in_body.setIdentity();
    const auto before = body_testing::predict(model, arm, {}, trial);
    const Matrix3Xd moved =
        body_testing::moved(model, measured, with("camera_scale", {0.0, 0.01, 0.0}), trial);
    const Vector3d up = -(mounting.conjugate() * arm.gravity_m_s2).normalized();
    for (Eigen::Index b = 0; b < kRings; ++b)
      EXPECT_LT((moved.col(b) - 0.01 * up.dot(before[0].p.col(b)) * up).norm(), 1e-12);
  }
}

TEST_F(BodySignatures, ABowGrowsWithTheDistanceFromTheCapturesOrigin) {
  auto trial = body_testing::trial_of(arm, {{inputs(0.7), 0.05, hanging()}, {inputs(0.7), 0.05, hanging()}});
  trial.blocks[0].base_in_mocap_m = {0.0, 0.0, 1.0};
  trial.blocks[1].base_in_mocap_m = {0.0, 0.0, 2.0};
  arm::Arm measured = arm;
  measured.base.body = "base";
  measured.base.rod_in_body.setIdentity();
  const auto before = body_testing::predict(model, arm, {}, trial);
  const Matrix3Xd moved = body_testing::moved(model, measured, with("camera_bow", {0.01}), trial);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Vector3d base(0.0, 0.0, 1.0 + static_cast<double>(k));
    const Vector3d tip = base + hanging() * Vector3d(before[static_cast<std::size_t>(k)].p.col(3));
    const Vector3d expected =
        hanging().conjugate() * Vector3d(0.01 * (tip.squaredNorm() * tip - base.squaredNorm() * base));
    EXPECT_LT((moved.col(kRings * k + 3) - expected).norm(), 1e-12);
  }
  EXPECT_GT(moved.col(7).norm(), 3.0 * moved.col(3).norm());
}

TEST_F(BodySignatures, MarkerSlipMovesOneRingByTheSameInItsOwnFrame) {
  const Matrix3Xd slip = moved(with("marker_slip", {0.0, 0.0, 2e-3, 3.0}),
                               {{inputs(0.0), 0.0, hanging()}, {inputs(0.9), 0.1, hanging()}});
  for (Eigen::Index c = 0; c < slip.cols(); ++c)
    EXPECT_NEAR(slip.col(c).norm(), c % kRings == 2 ? 2e-3 : 0.0, 1e-12);
  EXPECT_LT((slip.col(2) - Vector3d(0.0, 0.0, 2e-3)).norm(), 1e-12);
  EXPECT_LT(slip.col(6).z(), 1.98e-3) << "it turns with the arm";
}

}  // namespace
}  // namespace softarm::effects
