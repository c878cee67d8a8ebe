// What the cameras make of the space that they see: private to the rig.
#pragma once

#include <Eigen/Core>

#include "sensor_spec.h"

namespace softarm::rig {

/// Where something is measured that is at x, in the mocap frame. @param session_s time of the session
Eigen::Vector3d measured_at(const SensorSpec& spec, double session_s, const Eigen::Vector3d& x);

}  // namespace softarm::rig
