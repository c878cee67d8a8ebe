// What motion capture makes of the space that it measures.
#pragma once

#include <Eigen/Core>

#include "model/effect.h"

namespace softarm::effects {

/// Moves bodies as a distortion of the measured space does.
/// @param error from a place in mocap's frame to what is measured there less that place, m. The base is
/// measured too where the arm file names a body for it: then it is not where the base seems to be
template <typename Error>
void distort(const arm::Arm& arm, const model::Instant& instant, const Error& error, model::Bodies& bodies) {
  const Eigen::Matrix3d to_mocap = instant.q_base_mocap.conjugate().toRotationMatrix();
  Eigen::Vector3d of_base = Eigen::Vector3d::Zero();
  if (arm.base.body) {
    const Eigen::Isometry3d body_in_rod = arm.base.rod_in_body.inverse();
    of_base = error(Eigen::Vector3d(instant.base_in_mocap_m + to_mocap * body_in_rod.translation()));
  }
  for (Eigen::Index b = 0; b < bodies.p.cols(); ++b) {
    const Eigen::Vector3d of_body =
        error(Eigen::Vector3d(instant.base_in_mocap_m + to_mocap * bodies.p.col(b)));
    bodies.p.col(b) += to_mocap.transpose() * (of_body - of_base);
  }
}

}  // namespace softarm::effects
