// One instant of measurements, as the estimator sees it.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "softarm/arm/laws.h"

namespace softarm {

/// Pose of one measured body (index into Arm::bodies), as its driver reports it.
struct BodyObservation {
  int body = 0;
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();  ///< m
  std::optional<Eigen::Quaterniond> q_mocap;          ///< absent: position only
};

/// Everything known at one stamp. Absent is absent.
struct Frame {
  double stamp_s = 0.0;
  std::optional<Eigen::Isometry3d> base_body;  ///< pose of Base::body in mocap; unused for a fixed base
  std::vector<BodyObservation> bodies;
  InputValues inputs;                ///< empty or in the order of Arm::inputs.scalars
  std::optional<double> payload_kg;  ///< known payload; absent: PayloadMount::default_kg or unknown
};

}  // namespace softarm
