#include "body_kinematics.h"

#include <cmath>

#include "math/so3.h"

namespace softarm::model {

using Eigen::Vector3d;

Vector3d offset_from_backbone(const arm::MeasuredBody& body, const Eigen::Quaterniond& q_section) {
  if (!is_off_axis(body)) return Vector3d::Zero();
  return body.radius_m * (q_section * Vector3d(std::cos(body.angle_rad), std::sin(body.angle_rad), 0.0));
}

Vector3d position_on(const arm::MeasuredBody& body, const rod::RodState& section) {
  return section.p + offset_from_backbone(body, section.q);
}

void carry_position(const arm::MeasuredBody& body, const rod::RodState& section,
                    const Eigen::Ref<const Eigen::Matrix3Xd>& turn, Eigen::Ref<Eigen::Matrix3Xd> derivative) {
  if (is_off_axis(body)) derivative -= math::skew(offset_from_backbone(body, section.q)) * turn;
}

Eigen::Matrix3Xd tangent_derivative(const rod::RodState& section,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& turn) {
  return -math::skew(tangent_of(section)) * turn;
}

}  // namespace softarm::model
