// Frames whose truth is known, for the tests of the estimator.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "softarm/arm/arm_file.h"
#include "softarm/estimate/estimator.h"
#include "softarm/rod/solver.h"

namespace softarm::estimate::testing {

struct SegmentTruth {
  double moment_nm = 0.0;
  double direction_rad = 0.0;
  double bending_stiffness_nm2 = 0.03;
  double length_m = 0.2;
};

struct Truth {
  std::vector<SegmentTruth> segments;
  double payload_kg = 0.0;
  Eigen::Isometry3d rod_base_in_mocap = Eigen::Isometry3d::Identity();
};

inline Eigen::Isometry3d pose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  Eigen::Isometry3d x = Eigen::Isometry3d::Identity();
  x.linear() = q.normalized().toRotationMatrix();
  x.translation() = p;
  return x;
}

/// Base frames whose z axis points down, up, and along the mocap frame's x axis.
inline Eigen::Isometry3d hanging() {
  return pose({0.0, 0.0, 0.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0));
}
inline Eigen::Isometry3d standing() {
  return Eigen::Isometry3d::Identity();
}
inline Eigen::Isometry3d horizontal() {
  return pose({0.0, 0.0, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY())));
}

inline arm::Arm paper_arm() {
  return arm::load_arm_file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml");
}

/// The paper's arm twice in series, the distal one lighter and softer, three rings on each; the payload at
/// the tip.
inline arm::Arm two_segment_arm() {
  arm::Arm arm = paper_arm();
  arm::Segment distal = arm.segments[0];
  arm.segments[0].name = "proximal";
  distal.name = "distal";
  distal.length_m = 0.15;
  distal.length_range_m = {0.1, 0.2};
  distal.mass_per_length_kg_m = 0.5;
  distal.bending_stiffness.base_nm2 = 0.02;
  arm.segments.push_back(distal);
  const arm::MeasuredBody ring = arm.bodies[0];
  arm.bodies.clear();
  for (const double s : {0.07, 0.14, 0.2, 0.25, 0.3, 0.35}) {
    arm::MeasuredBody body = ring;
    body.name = "ring_" + std::to_string(arm.bodies.size() + 1);
    body.arclength_m = s;
    body.orientation_usable = s == 0.2 || s == 0.35;
    arm.bodies.push_back(body);
  }
  arm.payload.arclength_m = 0.35;
  return arm;
}

/// The arm with markers that are said to be measured to a micrometre. (EI and M0 are freed of their
/// second-order bias, which the stated noise decides: half a millimetre stated on a frame without noise would
/// show as an error.)
inline arm::Arm precisely_measured(arm::Arm arm) {
  for (arm::MeasuredBody& body : arm.bodies) {
    body.position_sd_m = 1e-6;
    body.orientation_sd_rad = 1e-5;
  }
  return arm;
}

/// The arm with bodies that are known to sit exactly where the arm file says.
inline arm::Arm placed_exactly(arm::Arm arm) {
  for (arm::MeasuredBody& body : arm.bodies) body.placement_sd_m = body.placement_sd_rad = 0.0;
  return arm;
}

/// Makes frames of an arm with the rod's statics: the arm's model is exact in these tests.
class FrameMaker {
 public:
  explicit FrameMaker(const arm::Arm& arm)
      : arm_(arm), rod_(rod::make_rod(arm)), solver_(rod_, stations(arm), {}) {}

  /// Noiseless frame with a known payload and the poses of all bodies; nothing where the arm has no stable
  /// equilibrium.
  std::optional<trial::Frame> make(const Truth& truth) {
    rod_.p_base = truth.rod_base_in_mocap.translation();
    rod_.q_base = Eigen::Quaterniond(truth.rod_base_in_mocap.linear());
    for (std::size_t i = 0; i < rod_.segments.size(); ++i) {
      const SegmentTruth& from = truth.segments.at(i);
      rod::Segment& to = rod_.segments[i];
      to.bending_compliance = 1.0 / from.bending_stiffness_nm2;
      to.length_m = from.length_m;
      to.moment_nm =
          from.moment_nm * Eigen::Vector3d(-std::sin(from.direction_rad), std::cos(from.direction_rad), 0.0);
    }
    rod_.loads[rod::kPayloadLoad].mass_kg = truth.payload_kg;
    if (solver_.solve(rod_) != rod::SolveStatus::kConverged || !solver_.stable()) return std::nullopt;

    trial::Frame frame;
    frame.payload_kg = truth.payload_kg;
    frame.base_body = truth.rod_base_in_mocap * arm_.base.rod_in_body.inverse();
    for (int i = 0; i < static_cast<int>(arm_.bodies.size()); ++i) {
      const arm::MeasuredBody& body = arm_.bodies[static_cast<std::size_t>(i)];
      const rod::RodState& state = solver_.station(i);
      trial::BodyObservation seen;
      seen.body = i;
      if (body.kind == arm::BodyKind::kRing) {
        const Eigen::Isometry3d x = pose(state.p, state.q) * body.section_in_body.inverse();
        seen.p_mocap = x.translation();
        seen.q_mocap = Eigen::Quaterniond(x.linear());
      } else {
        const Eigen::Vector3d radial(std::cos(body.angle_rad), std::sin(body.angle_rad), 0.0);
        seen.p_mocap = state.p + body.radius_m * (state.q * radial);
      }
      frame.bodies.push_back(seen);
    }
    return frame;
  }

  /// Angle between the tangents at base and tip of the last frame made.
  double tip_angle_rad() const {
    const Eigen::Vector3d base = rod_.q_base * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d tip = solver_.station(solver_.stations() - 1).q * Eigen::Vector3d::UnitZ();
    return std::atan2(base.cross(tip).norm(), base.dot(tip));
  }

 private:
  static std::vector<double> stations(const arm::Arm& arm) {
    std::vector<double> list;
    for (const arm::MeasuredBody& body : arm.bodies) list.push_back(body.arclength_m);
    list.push_back(arm.total_length_m());
    return list;
  }

  const arm::Arm arm_;
  rod::Rod rod_;
  rod::Solver solver_;
};

inline trial::Frame make_frame(const arm::Arm& arm, const Truth& truth) {
  std::optional<trial::Frame> frame = FrameMaker(arm).make(truth);
  if (!frame) throw std::logic_error("the truth of a test has no stable equilibrium");
  return *frame;
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Eigen::Vector3d normal3(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

/// The frame with each body's stated noise added to its position and, as a small rotation, to its
/// orientation.
inline trial::Frame with_noise(const arm::Arm& arm, trial::Frame frame, std::mt19937_64& random) {
  for (trial::BodyObservation& seen : frame.bodies) {
    const arm::MeasuredBody& body = arm.bodies[static_cast<std::size_t>(seen.body)];
    seen.p_mocap += body.position_sd_m * normal3(random);
    if (seen.q_mocap) {
      const Eigen::Vector3d turn = body.orientation_sd_rad * normal3(random);
      seen.q_mocap = *seen.q_mocap * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    }
  }
  return frame;
}

inline arm::EstimatorOptions with_method(arm::Method method,
                                         arm::Unknown unknown = arm::Unknown::kStiffness) {
  arm::EstimatorOptions options;
  options.method = method;
  options.unknown = unknown;
  return options;
}

/// One segment of the estimate against truth, to the share `relative` of each value.
inline void expect_truth(const estimate::Estimate& estimate, const Truth& truth, double relative) {
  ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
  ASSERT_EQ(estimate.segments.size(), truth.segments.size());
  for (std::size_t i = 0; i < truth.segments.size(); ++i) {
    SCOPED_TRACE("segment " + std::to_string(i));
    const estimate::SegmentEstimate& found = estimate.segments[i];
    const SegmentTruth& expected = truth.segments[i];
    EXPECT_NEAR(found.moment_nm.value(), expected.moment_nm, relative * expected.moment_nm);
    EXPECT_NEAR(std::remainder(found.direction_rad.value() - expected.direction_rad, 2.0 * M_PI), 0.0,
                relative);
    EXPECT_NEAR(found.bending_stiffness_nm2.value(), expected.bending_stiffness_nm2,
                relative * expected.bending_stiffness_nm2);
    EXPECT_NEAR(found.length_m.value(), expected.length_m, relative * expected.length_m);
    const double curvature = expected.moment_nm / expected.bending_stiffness_nm2;
    EXPECT_NEAR(found.actuation_curvature_per_m.value(), curvature, relative * curvature);
  }
}

/// The standard deviations of EI and M0 reach as far as EI = EI_base / c does upwards where c is a standard
/// deviation less: by this factor farther than along the tangent, as the scatter of EI is.
inline double upwards(const estimate::SegmentEstimate& estimate) {
  const double stated = estimate.sd_bending_stiffness_nm2.value() / estimate.bending_stiffness_nm2.value();
  double relative = stated;  // of c: stated = relative (1 + relative^2) / (1 - relative)
  for (int i = 0; i < 50; ++i) relative = stated / (stated + 1.0 + relative * relative);
  return 1.0 / (1.0 - relative);
}

inline void expect_positive_semidefinite(const Eigen::Matrix4d& covariance) {
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-12) || covariance.isZero());
  // Scaled to ones on the diagonal: the four units differ by orders of magnitude.
  Eigen::Vector4d scale;
  for (int i = 0; i < 4; ++i) scale[i] = covariance(i, i) > 0.0 ? 1.0 / std::sqrt(covariance(i, i)) : 0.0;
  const Eigen::Matrix4d scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(scaled).eigenvalues().minCoeff(), -1e-9);
}

}  // namespace softarm::estimate::testing
