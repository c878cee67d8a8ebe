#include "capture_space.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace softarm::rig {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d scaled(const CameraScale& scale, double session_s, const Vector3d& x) {
  const double warm = scale.warms_s > 0.0 ? -std::expm1(-session_s / scale.warms_s) : 1.0;
  return x + scale.share * warm * Vector3d(x.x(), x.y(), scale.height_ratio * x.z());
}

/// Where the rays that the cameras take for those to x are nearest to each other, in least squares.
Vector3d through_lenses(const CameraBow& bow, const Vector3d& x) {
  Matrix3d sum = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (int i = 0; i < bow.cameras; ++i) {
    const double azimuth = 2.0 * M_PI * i / bow.cameras;
    const Vector3d camera(bow.ring_m * std::cos(azimuth), bow.ring_m * std::sin(azimuth), bow.height_m);
    const Vector3d axis = -camera.normalized(), to_x = x - camera;
    const Vector3d across = to_x / to_x.dot(axis) - axis;
    const Vector3d ray = (axis + across * (1.0 + bow.off * across.squaredNorm())).normalized();
    const Matrix3d off_ray = Matrix3d::Identity() - ray * ray.transpose();
    sum += off_ray;
    right += off_ray * camera;
  }
  return sum.inverse() * right;
}

Vector3d bowed(const CameraBow& bow, const Vector3d& x) {
  if (bow.form == CameraBow::Form::kLenses) return through_lenses(bow, x);
  const double square = x.squaredNorm();
  return x * (1.0 + bow.off * square / (1.0 + square / (bow.fades_m * bow.fades_m)));
}

}  // namespace

Vector3d measured_at(const SensorSpec& spec, double session_s, const Vector3d& x) {
  Vector3d measured = x;
  for (const CameraBow& bow : spec.camera_bows)
    if (bow.off != 0.0) measured = bowed(bow, measured);
  for (const CameraScale& scale : spec.camera_scales) measured = scaled(scale, session_s, measured);
  return measured;
}

}  // namespace softarm::rig
