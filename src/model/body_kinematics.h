// Measured bodies on a rod: where a section carries them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "softarm/arm/arm.h"
#include "softarm/rod/solver.h"

namespace softarm::model {

/// Whether it sits beside the backbone, so that it moves when its section turns.
inline bool is_off_axis(const arm::MeasuredBody& body) {
  return body.kind == arm::BodyKind::kSkinMarker;
}

/// From the backbone to the body, in the frame of the section's orientation; 0 for rings.
Eigen::Vector3d offset_from_backbone(const arm::MeasuredBody& body, const Eigen::Quaterniond& q_section);

/// Position of a body on a section, m, and the tangent there.
Eigen::Vector3d position_on(const arm::MeasuredBody& body, const rod::RodState& section);
inline Eigen::Vector3d tangent_of(const rod::RodState& section) {
  return section.q * Eigen::Vector3d::UnitZ();
}

/// Makes the derivative of the backbone's position (3 x n) that of the body's.
/// @param turn rotation vector of the section by the same, 3 x n; not looked at for bodies on the axis
void carry_position(const arm::MeasuredBody& body, const rod::RodState& section,
                    const Eigen::Ref<const Eigen::Matrix3Xd>& turn, Eigen::Ref<Eigen::Matrix3Xd> derivative);
/// Derivative of the tangent where the section turns by `turn`.
Eigen::Matrix3Xd tangent_derivative(const rod::RodState& section,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& turn);

}  // namespace softarm::model
