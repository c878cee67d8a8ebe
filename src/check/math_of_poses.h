// Small rotations and directions.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "math/so3.h"

namespace softarm::check {

/// Rotation vector that takes a to b, in a's frame; the shorter way round.
inline Eigen::Vector3d rotation_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::Quaterniond d = a.conjugate() * b;
  if (d.w() < 0.0) d.coeffs() *= -1.0;
  return math::log_so3(d);
}

inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace softarm::check
