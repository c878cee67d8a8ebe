// Without noise the estimate is the truth.
#include <gtest/gtest.h>

#include "frames.h"
#include "math/so3.h"

namespace softarm::estimate::testing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kExact = 1e-4;  // of each value; half a millimetre of noise makes errors of 1e-2 to 1e-1

/// Somewhere in the room, turned by everything.
Eigen::Isometry3d odd_base() {
  return pose({1.7, -2.4, 0.9}, Quaterniond(0.4, -0.7, 0.3, 0.5));
}

TEST(FullPoints, RecoverTheTruthAtEveryAttitudeOfTheBase) {
  const arm::Arm arm = precisely_measured(paper_arm());
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  for (const Eigen::Isometry3d& base : {hanging(), standing(), horizontal(), odd_base()}) {
    for (const double phi : {-2.6, -0.4, 1.2, 3.1}) {
      const Truth truth{{{0.25, phi, 0.04, 0.207}}, 0.18, base};
      estimator.reset();
      const estimate::Estimate& estimate = estimator.estimate(make_frame(arm, truth));
      expect_truth(estimate, truth, kExact);
      EXPECT_LT(estimate.rms_residual_m, 1e-7);
      EXPECT_EQ(estimate.payload_kg, 0.18);
      EXPECT_FALSE(estimate.sd_payload_kg);
      EXPECT_TRUE(estimate.base_in_mocap.isApprox(base, 1e-12));
    }
  }
}

TEST(Estimator, OfWhichNothingIsKeptLeavesItsEstimateBehind) {
  const arm::Arm arm = precisely_measured(paper_arm());
  const Truth truth{{{0.25, 0.8, 0.04, 0.207}}, 0.18, hanging()};
  const estimate::Estimate& kept =
      estimate::Estimator(arm, with_method(arm::Method::kFullPoints)).estimate(make_frame(arm, truth));
  expect_truth(kept, truth, kExact);
}

TEST(FullPoints, KnowTheMountOfRodAndRings) {
  arm::Arm arm = precisely_measured(paper_arm());
  arm.base.rod_in_body = pose({0.02, -0.03, 0.05}, Quaterniond(0.8, 0.1, -0.5, 0.3));
  for (arm::MeasuredBody& body : arm.bodies) {
    body.section_in_body = pose({0.012, 0.004, -0.02}, Quaterniond(0.6, 0.2, 0.7, -0.1));
  }
  const Truth truth{{{0.3, 0.8, 0.03, 0.2}}, 0.2, odd_base()};
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const estimate::Estimate& estimate = estimator.estimate(make_frame(arm, truth));
  expect_truth(estimate, truth, kExact);
  EXPECT_TRUE(estimate.base_in_mocap.isApprox(truth.rod_base_in_mocap, 1e-12));
}

TEST(FullPoints, TwoSegmentsEachHaveTheirOwnEstimate) {
  const arm::Arm arm = precisely_measured(two_segment_arm());
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  for (const Eigen::Isometry3d& base : {hanging(), odd_base()}) {
    const Truth truth{{{0.3, 0.5, 0.035, 0.205}, {0.2, -1.9, 0.018, 0.148}}, 0.1, base};
    estimator.reset();
    const estimate::Estimate& estimate = estimator.estimate(make_frame(arm, truth));
    expect_truth(estimate, truth, 10.0 * kExact);
    for (const estimate::SegmentEstimate& segment : estimate.segments) {
      ASSERT_TRUE(segment.sd_bending_stiffness_nm2 && segment.sd_moment_nm && segment.sd_length_m);
      expect_positive_semidefinite(segment.covariance);
    }
  }
}

/// A joint that yields is neither flexibility of the segment nor payload, once the arm file has it.
TEST(FullPoints, KnowJointsThatYield) {
  arm::Arm arm = precisely_measured(two_segment_arm());
  const arm::Arm rigid = arm;
  arm.segments[0].joint_compliance_rad_per_nm = 0.5;
  arm.segments[1].joint_compliance_rad_per_nm = 0.9;
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints)),
      unaware(rigid, with_method(arm::Method::kFullPoints));
  for (const Eigen::Isometry3d& base : {hanging(), horizontal(), odd_base()}) {
    const Truth truth{{{0.3, 0.5, 0.035, 0.205}, {0.2, -1.9, 0.018, 0.148}}, 0.1, base};
    estimator.reset();
    expect_truth(estimator.estimate(make_frame(arm, truth)), truth, 10.0 * kExact);
    unaware.reset();
    const estimate::Estimate& wrong = unaware.estimate(make_frame(arm, truth));
    ASSERT_EQ(wrong.status, estimate::Status::kOk) << wrong.detail;
    double off = 0.0;  // the shape is fitted, by a stiffness that is not the arm's
    for (std::size_t i = 0; i < truth.segments.size(); ++i) {
      const double stiffness = truth.segments[i].bending_stiffness_nm2;
      off = std::max(off, std::abs(wrong.segments[i].bending_stiffness_nm2.value() / stiffness - 1.0));
    }
    EXPECT_GT(off, 0.01);
  }
}

TEST(FullPoints, SkinMarkersSitOffTheBackbone) {
  arm::Arm arm = precisely_measured(paper_arm());
  arm::MeasuredBody marker = arm.bodies[0];
  marker.kind = arm::BodyKind::kSkinMarker;
  marker.radius_m = 0.02;
  arm.bodies.clear();
  for (int i = 0; i < 6; ++i) {
    marker.name = "skin_" + std::to_string(i + 1);
    marker.arclength_m = 0.2 * (i / 2 + 1) / 3.0;
    marker.angle_rad = 2.1 * i - 0.7;
    arm.bodies.push_back(marker);
  }
  const Truth truth{{{0.3, -2.2, 0.035, 0.195}}, 0.22, odd_base()};
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  expect_truth(estimator.estimate(make_frame(arm, truth)), truth, kExact);
}

TEST(FullPoints, PayloadOutOfTheBendingPlane) {
  arm::Arm arm = precisely_measured(paper_arm());
  arm.payload.offset_m = {0.02, 0.06, 0.02};
  arm.segments[0].torsional_stiffness_nm2 = 0.025;
  // The arm bends in a horizontal plane, to which gravity is normal.
  const Truth truth{{{0.3, M_PI / 2.0, 0.03, 0.2}}, 0.2, horizontal()};
  const trial::Frame frame = make_frame(arm, truth);
  // The shape is no plane curve: the planar equations of the paper could not explain it.
  Eigen::Matrix<double, 3, 4> points;
  for (int i = 0; i < 4; ++i) {
    points.col(i) = truth.rod_base_in_mocap.inverse() * frame.bodies[static_cast<std::size_t>(i)].p_mocap;
  }
  const Vector3d normal = points.col(1).cross(points.col(3)).normalized();
  ASSERT_GT((normal.transpose() * points).cwiseAbs().maxCoeff(), 0.0008);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  expect_truth(estimator.estimate(frame), truth, kExact);
}

TEST(FullPoints, BackboneRunsFromBaseToTipThroughTheBodies) {
  const arm::Arm arm = precisely_measured(paper_arm());
  const Truth truth{{{0.35, 1.0, 0.03, 0.21}}, 0.15, odd_base()};
  const trial::Frame frame = make_frame(arm, truth);
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  estimator.set_backbone_points(41);
  const estimate::Estimate& estimate = estimator.estimate(frame);
  ASSERT_EQ(estimate.status, estimate::Status::kOk);
  ASSERT_EQ(estimate.backbone.size(), 41u);
  EXPECT_TRUE(estimate.backbone.front().p_base.isZero(1e-12));
  for (int i = 0; i < 4; ++i) {  // rings at every tenth point
    const estimate::BackbonePoint& point = estimate.backbone[static_cast<std::size_t>(10 * (i + 1))];
    const trial::BodyObservation& seen = frame.bodies[static_cast<std::size_t>(i)];
    EXPECT_NEAR(point.arclength_m, 0.05 * (i + 1), 1e-12);
    EXPECT_LT((truth.rod_base_in_mocap * point.p_base - seen.p_mocap).norm(), 1e-6);
    const Quaterniond q = Quaterniond(truth.rod_base_in_mocap.linear()) * point.q_base;
    EXPECT_LT(math::log_so3(q.conjugate() * *seen.q_mocap).norm(), 1e-5);
  }
  const Vector3d tip = estimate.backbone.back().q_base * Vector3d::UnitZ();
  EXPECT_NEAR(estimate.segments[0].bending_angle_rad, std::acos(tip.z()), 1e-9);
  estimator.set_backbone_points(0);
  EXPECT_TRUE(estimator.estimate(frame).backbone.empty());
}

TEST(EndOrientation, TipPoseAloneGivesTheTruth) {
  const arm::Arm arm = precisely_measured(paper_arm());
  estimate::Estimator estimator(arm, with_method(arm::Method::kEndOrientation));
  for (const Eigen::Isometry3d& base : {hanging(), standing(), odd_base()}) {
    const Truth truth{{{0.3, -0.9, 0.04, 0.205}}, 0.2, base};
    trial::Frame frame = make_frame(arm, truth);
    frame.bodies.erase(frame.bodies.begin(), frame.bodies.end() - 1);
    estimator.reset();
    const estimate::Estimate& estimate = estimator.estimate(frame);
    expect_truth(estimate, truth, 10.0 * kExact);
    EXPECT_EQ(estimate.residuals.size(), 1u);
  }
}

TEST(EndOrientation, EachSegmentsEndGivesTheTruth) {
  const arm::Arm arm = precisely_measured(two_segment_arm());
  estimate::Estimator estimator(arm, with_method(arm::Method::kEndOrientation));
  const Truth truth{{{0.35, 0.5, 0.035, 0.205}, {0.25, -1.9, 0.018, 0.148}}, 0.1, hanging()};
  expect_truth(estimator.estimate(make_frame(arm, truth)), truth, 10.0 * kExact);
}

TEST(EndOrientation, NeedsAUsableOrientation) {
  arm::Arm arm = precisely_measured(paper_arm());
  trial::Frame frame = make_frame(arm, {{{0.3, 0.0, 0.04, 0.2}}, 0.2, hanging()});
  frame.bodies.back().q_mocap.reset();
  EXPECT_EQ(estimate::Estimator(arm, with_method(arm::Method::kEndOrientation)).estimate(frame).status,
            estimate::Status::kNotEnoughBodies);
  for (arm::MeasuredBody& body : arm.bodies) body.orientation_usable = false;
  EXPECT_THROW(estimate::Estimator(arm, with_method(arm::Method::kEndOrientation)), std::invalid_argument);
}

TEST(UnknownPayload, IsRecoveredWithKnownStiffness) {
  const arm::Arm arm = precisely_measured(paper_arm());
  // The law: 0.027 + 3e-7 * min(P), chambers as gauge pressures.
  const arm::InputValues inputs{10e3, 40e3, 25e3};
  const double stiffness = 0.027 + 3e-7 * 10e3;
  for (const arm::Method method : {arm::Method::kFullPoints, arm::Method::kEndOrientation}) {
    for (const Eigen::Isometry3d& base : {hanging(), standing(), odd_base()}) {
      const Truth truth{{{0.3, 2.0, stiffness, 0.205}}, 0.17, base};
      trial::Frame frame = make_frame(arm, truth);
      frame.payload_kg.reset();
      frame.inputs = inputs;
      estimate::Estimator estimator(arm, with_method(method, arm::Unknown::kPayload));
      const estimate::Estimate& estimate = estimator.estimate(frame);
      expect_truth(estimate, truth, 10.0 * kExact);
      EXPECT_NEAR(estimate.payload_kg.value(), 0.17, 1e-3 * 0.17);
      ASSERT_TRUE(estimate.sd_payload_kg);
      EXPECT_EQ(estimate.identifiable_payload, *estimate.sd_payload_kg < 0.25 * *estimate.payload_kg);
      EXPECT_FALSE(estimate.segments[0].sd_bending_stiffness_nm2) << "it is known, not estimated";
      EXPECT_FALSE(estimate.segments[0].identifiable_stiffness);
      EXPECT_TRUE(estimate.segments[0].sd_moment_nm);
    }
  }
}

TEST(UnknownPayload, NeedsThePressuresOfAStiffnessLaw) {
  arm::Arm arm = precisely_measured(paper_arm());
  trial::Frame frame = make_frame(arm, {{{0.3, 2.0, 0.03, 0.2}}, 0.17, hanging()});
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints, arm::Unknown::kPayload));
  EXPECT_EQ(estimator.estimate(frame).status, estimate::Status::kMissingInputs);
  frame.inputs = {10e3, std::nullopt, 25e3};
  EXPECT_EQ(estimator.estimate(frame).status, estimate::Status::kMissingInputs);
  EXPECT_EQ(estimator.estimate(frame).detail,
            "segment 'segment_1': its stiffness depends on chamber_2, absent or too old");
  frame.inputs = {10e3, 40e3, 25e3};
  EXPECT_EQ(estimator.estimate(frame).status, estimate::Status::kOk);

  arm.segments[0].bending_stiffness = arm::StiffnessLaw();  // a stiffness that no pressure changes
  arm.segments[0].bending_stiffness.base_nm2 = 0.03;
  frame.inputs.clear();
  const estimate::Estimate estimate =
      estimate::Estimator(arm, with_method(arm::Method::kFullPoints, arm::Unknown::kPayload)).estimate(frame);
  ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
}

TEST(UnknownStiffness, NeedsAPayloadOrADefault) {
  arm::Arm arm = precisely_measured(paper_arm());
  const Truth truth{{{0.3, 2.0, 0.03, 0.2}}, 0.17, hanging()};
  trial::Frame frame = make_frame(arm, truth);
  frame.payload_kg.reset();
  EXPECT_EQ(estimate::Estimator(arm, with_method(arm::Method::kFullPoints)).estimate(frame).status,
            estimate::Status::kMissingPayload);
  arm.payload.default_kg = 0.17;
  estimate::Estimator with_default(arm, with_method(arm::Method::kFullPoints));
  expect_truth(with_default.estimate(frame), truth, kExact);
}

TEST(UnknownStiffness, CanBeExchangedForPayload) {
  const arm::Arm arm = precisely_measured(paper_arm());
  const Truth truth{{{0.3, 2.0, 0.03, 0.2}}, 0.17, hanging()};
  trial::Frame frame = make_frame(arm, truth);
  frame.inputs = {10e3, 40e3, 25e3};
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  estimator.set_backbone_points(7);
  expect_truth(estimator.estimate(frame), truth, kExact);
  frame.payload_kg.reset();
  EXPECT_EQ(estimator.estimate(frame).status, estimate::Status::kMissingPayload);
  estimator.set_unknown(arm::Unknown::kPayload);
  EXPECT_EQ(estimator.options().unknown, arm::Unknown::kPayload);
  const estimate::Estimate& estimate = estimator.estimate(frame);
  expect_truth(estimate, truth, kExact);
  EXPECT_NEAR(estimate.payload_kg.value(), 0.17, kExact);
  EXPECT_EQ(estimate.backbone.size(), 7u);
}

}  // namespace
}  // namespace softarm::estimate::testing
