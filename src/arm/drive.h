// What drives a segment, before its wall answers; and what the wall makes of it.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "input_reader.h"
#include "softarm/arm/laws.h"

namespace softarm::arm {

/// What all actuators of a segment do together. Every field is a sum, so that a derivative of a drive is a
/// drive as well.
struct Drive {
  double length_m = 0.0;       ///< that chambers make of it, before the wall is stretched
  double axial_force_n = 0.0;  ///< tension of the wall
  Eigen::Vector2d moment_nm = Eigen::Vector2d::Zero();
  Eigen::Vector2d curvature_per_m = Eigen::Vector2d::Zero();
  double base_stiffness_nm2 = 0.0;   ///< EI of the wall
  bool base_with_modulus = true;     ///< which goes with the material's modulus; not where it was measured
  double added_stiffness_nm2 = 0.0;  ///< EI beside the wall's
  double shear_stiffness_n = 0.0, torsional_stiffness_nm2 = 0.0;  ///< of taut tendons
};

inline Eigen::Vector2d towards(double azimuth_rad) {
  return {std::cos(azimuth_rad), std::sin(azimuth_rad)};
}

/// What changes per unit of a constant.
struct Change {
  Drive drive;  ///< derivative of the drive
  double axial_stiffness_n = 0.0;
  double joint_compliance_rad_per_nm = 0.0;
  Eigen::Vector2d rest_curvature_per_m = Eigen::Vector2d::Zero();
};

/// Axial stretch of the wall, and the tangent modulus there over the unstretched one, with their derivatives
/// by the strain of a linear material.
struct Stretch {
  double stretch = 1.0;
  double modulus_ratio = 1.0;
  double stretch_by_strain = 1.0, modulus_ratio_by_strain = 0.0;
};

/// A prediction with what it was made of.
struct SegmentResponse {
  Drive drive;
  Stretch stretch;
  SegmentPrediction prediction;
};

/// Derivative of what is made of a segment.
struct SegmentDerivative {
  SegmentPrediction prediction;  ///< field by field: modulus_ratio is 0 where it does not change
  double axial_stiffness_n = 0.0;
  double joint_compliance_rad_per_nm = 0.0;
  Eigen::Vector2d rest_curvature_per_m = Eigen::Vector2d::Zero();

  /// Of SegmentPrediction::actuation_nm(). @param at which the derivative was taken
  Eigen::Vector2d actuation_nm(const SegmentPrediction& at) const {
    return prediction.moment_nm + prediction.bending_stiffness_nm2 * at.curvature_per_m +
           at.bending_stiffness_nm2 * prediction.curvature_per_m;
  }
};

/// All actuators of a segment. @return nothing where an input that they need is absent
std::optional<Drive> drive_of(const Segment& segment, const InputReader& inputs);

/// @return nothing where predict_segment() has nothing
std::optional<SegmentResponse> respond(const Segment& segment, const InputReader& inputs);

/// What a change of the drive makes of the response.
SegmentDerivative differentiate(const Segment& segment, const SegmentResponse& at, const Change& change);

}  // namespace softarm::arm
