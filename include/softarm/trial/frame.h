// One instant of measurements, as the estimator sees it.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "softarm/arm/laws.h"

namespace softarm::trial {

/// Pose of one measured body (index into Arm::bodies), as its driver reports it.
struct BodyObservation {
  int body = 0;
  Eigen::Vector3d p_mocap = Eigen::Vector3d::Zero();  ///< m
  std::optional<Eigen::Quaterniond> q_mocap;          ///< absent: position only
};

/// One value of an input by its own stamp.
struct InputSample {
  int input = 0;              ///< index into Arm::inputs.scalars
  std::int64_t stamp_ns = 0;  ///< the instant that it means: its latency is subtracted
  double value = 0.0;         ///< as in Frame::inputs: gauge Pa, Pa below ambient, N, rad
};

/// Everything known at one stamp. Absent is absent.
struct Frame {
  double stamp_s = 0.0;
  std::optional<Eigen::Isometry3d> base_body;  ///< pose of Base::body in mocap; unused for a fixed base
  std::vector<BodyObservation> bodies;
  arm::InputValues inputs;           ///< empty or in the order of Arm::inputs.scalars
  std::optional<double> payload_kg;  ///< known payload; absent: PayloadMount::default_kg or unknown
  /// What came of the inputs since the frame before, up to this one's stamp; by input, then by stamp. Empty
  /// where their stamps are not known.
  std::vector<InputSample> samples;
};

}  // namespace softarm::trial
