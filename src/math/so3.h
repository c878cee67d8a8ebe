// Rotations: exponential, logarithm and the products that rod mechanics needs.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace softarm::math {

/// Matrix [v]x with [v]x w = v x w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// Unit quaternion of the rotation vector r (rad); accurate for tiny angles.
inline Eigen::Quaterniond exp_so3(const Eigen::Vector3d& r) {
  const double angle2 = r.squaredNorm();
  double cos_half, sinc_half;  // cos(angle / 2), sin(angle / 2) / angle
  if (angle2 < 1e-8) {
    cos_half = 1.0 - angle2 / 8.0;
    sinc_half = 0.5 - angle2 / 48.0;
  } else {
    const double angle = std::sqrt(angle2);
    cos_half = std::cos(0.5 * angle);
    sinc_half = std::sin(0.5 * angle) / angle;
  }
  const Eigen::Vector3d v = sinc_half * r;
  return Eigen::Quaterniond(cos_half, v.x(), v.y(), v.z()).normalized();
}

/// Rotation vector (rad, norm <= pi) of a unit quaternion; q and -q give the same.
inline Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double s = q.vec().norm();
  const double w = sign * q.w();
  const double scale = s < 1e-9 ? 2.0 / w : 2.0 * std::atan2(s, w) / s;
  return sign * scale * q.vec();
}

/// Inverse of the left Jacobian of SO(3) at r: exp(r + J_l^-1(r) d) = exp(d) exp(r) to first order in d.
inline Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& r) {
  const double angle2 = r.squaredNorm();
  double c;
  if (angle2 < 1e-6) {
    c = 1.0 / 12.0 + angle2 / 720.0;
  } else {
    const double angle = std::sqrt(angle2);
    c = 1.0 / angle2 - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  }
  const Eigen::Matrix3d k = skew(r);
  return Eigen::Matrix3d::Identity() - 0.5 * k + c * k * k;
}

}  // namespace softarm::math
