// The constant-curvature methods on arcs written down in closed form.
#include <gtest/gtest.h>

#include "frames.h"

namespace softarm::estimate::testing {
namespace {

using Eigen::Vector3d;

struct ArcTruth {
  double curvature_per_m, direction_rad, length_m;
};

/// Pose at arclength `at` of an arc that starts at the origin along z and bends towards `direction_rad`.
Eigen::Isometry3d along_arc(const ArcTruth& arc, double at) {
  const double angle = arc.curvature_per_m * at;
  const double across = arc.curvature_per_m > 0.0 ? (1.0 - std::cos(angle)) / arc.curvature_per_m : 0.0;
  const double up = arc.curvature_per_m > 0.0 ? std::sin(angle) / arc.curvature_per_m : at;
  const Vector3d towards(std::cos(arc.direction_rad), std::sin(arc.direction_rad), 0.0);
  Eigen::Isometry3d x = Eigen::Isometry3d::Identity();
  x.translation() = across * towards + up * Vector3d::UnitZ();
  x.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitZ().cross(towards)).toRotationMatrix();
  return x;
}

/// Rings where arcs in series put them.
trial::Frame arc_frame(const arm::Arm& arm, const std::vector<ArcTruth>& arcs,
                       const Eigen::Isometry3d& base) {
  trial::Frame frame;
  frame.base_body = base;
  for (int i = 0; i < static_cast<int>(arm.bodies.size()); ++i) {
    Eigen::Isometry3d x = base;
    double left = arm.bodies[static_cast<std::size_t>(i)].arclength_m;
    for (std::size_t k = 0; k < arcs.size() && left > 1e-12; ++k) {
      const double rest = arm.segments[k].length_m;
      x = x * along_arc(arcs[k], std::min(left, rest) / rest * arcs[k].length_m);
      left -= rest;
    }
    trial::BodyObservation seen;
    seen.body = i;
    seen.p_mocap = x.translation();
    frame.bodies.push_back(seen);
  }
  return frame;
}

void expect_arcs(const estimate::Estimate& estimate, const std::vector<ArcTruth>& arcs) {
  ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
  ASSERT_EQ(estimate.segments.size(), arcs.size());
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    SCOPED_TRACE(i);
    const estimate::SegmentEstimate& s = estimate.segments[i];
    EXPECT_NEAR(s.actuation_curvature_per_m.value(), arcs[i].curvature_per_m,
                1e-5 * arcs[i].curvature_per_m + 1e-6);
    if (arcs[i].curvature_per_m > 0.0) {
      EXPECT_NEAR(std::remainder(s.direction_rad.value() - arcs[i].direction_rad, 2.0 * M_PI), 0.0, 1e-5);
    }
    EXPECT_NEAR(s.length_m.value(), arcs[i].length_m, 1e-6);
    EXPECT_NEAR(s.bending_angle_rad, arcs[i].curvature_per_m * arcs[i].length_m, 1e-4);
    // An arc says nothing of loads.
    EXPECT_FALSE(s.bending_stiffness_nm2);
    EXPECT_FALSE(s.sd_bending_stiffness_nm2);
    EXPECT_FALSE(s.moment_nm);
    EXPECT_FALSE(s.sd_moment_nm);
    EXPECT_FALSE(s.identifiable_stiffness);
    EXPECT_FALSE(s.identifiable_moment);
    EXPECT_TRUE(s.sd_actuation_curvature_per_m);
    EXPECT_TRUE(s.sd_length_m);
  }
  EXPECT_LT(estimate.rms_residual_m, 1e-7);
}

class ConstantCurvature : public ::testing::TestWithParam<arm::Method> {};

TEST_P(ConstantCurvature, OneSegment) {
  const arm::Arm arm = paper_arm();
  estimate::Estimator estimator(arm, with_method(GetParam()));
  const Eigen::Isometry3d odd = pose({1.7, -2.4, 0.9}, Eigen::Quaterniond(0.4, -0.7, 0.3, 0.5));
  for (const ArcTruth& arc :
       {ArcTruth{2.0, 0.4, 0.2}, ArcTruth{12.0, -2.8, 0.21}, ArcTruth{0.0, 0.0, 0.19}}) {
    for (const Eigen::Isometry3d& base : {standing(), odd}) {
      estimator.reset();
      expect_arcs(estimator.estimate(arc_frame(arm, {arc}, base)), {arc});
    }
  }
}

TEST_P(ConstantCurvature, TwoSegments) {
  const arm::Arm arm = two_segment_arm();
  estimate::Estimator estimator(arm, with_method(GetParam()));
  const std::vector<ArcTruth> arcs{{6.0, 0.4, 0.205}, {9.0, -2.0, 0.145}};
  expect_arcs(estimator.estimate(arc_frame(arm, arcs, hanging())), arcs);
}

TEST_P(ConstantCurvature, NeitherPayloadNorPressuresMatter) {
  const arm::Arm arm = paper_arm();
  estimate::Estimator estimator(arm, with_method(GetParam()));
  trial::Frame frame = arc_frame(arm, {{5.0, 1.0, 0.2}}, hanging());
  const double without = estimator.estimate(frame).segments[0].actuation_curvature_per_m.value();
  EXPECT_FALSE(estimator.estimate(frame).payload_kg);
  frame.payload_kg = 0.3;
  EXPECT_NEAR(estimator.estimate(frame).segments[0].actuation_curvature_per_m.value(), without, 1e-7);
  EXPECT_EQ(estimator.estimate(frame).payload_kg, 0.3);
  EXPECT_FALSE(estimator.estimate(frame).sd_payload_kg);
}

INSTANTIATE_TEST_SUITE_P(Methods, ConstantCurvature,
                         ::testing::Values(arm::Method::kCcPoints, arm::Method::kCcEndpoint),
                         [](const ::testing::TestParamInfo<arm::Method>& method) {
                           return method.param == arm::Method::kCcPoints ? "Points" : "Endpoint";
                         });

TEST(ConstantCurvatureEndpoint, UsesTheEndAloneAndNeedsIt) {
  const arm::Arm arm = paper_arm();
  estimate::Estimator estimator(arm, with_method(arm::Method::kCcEndpoint));
  trial::Frame frame = arc_frame(arm, {{5.0, 1.0, 0.2}}, hanging());
  for (int i = 0; i < 3; ++i)
    frame.bodies[static_cast<std::size_t>(i)].p_mocap += Vector3d(0.01, 0.02, -0.01);
  expect_arcs(estimator.estimate(frame), {{5.0, 1.0, 0.2}});
  frame.bodies.pop_back();
  EXPECT_NE(estimator.estimate(frame).status, estimate::Status::kOk);
  arm::Arm open_end = arm;
  open_end.bodies.pop_back();
  EXPECT_THROW(estimate::Estimator(open_end, with_method(arm::Method::kCcEndpoint)), std::invalid_argument);
}

}  // namespace
}  // namespace softarm::estimate::testing
