// How the arm moved in the frames that are fitted, and so by how much statics are wrong of them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"
#include "trial/static_frame.h"

namespace softarm::identify {

/// Zero where the frames about it are too few to tell.
struct FrameMotion {
  /// What inertia adds to gravity, in the base frame, m/s^2: evenly along the arm, of the same effect as a
  /// swing of the arm, whose acceleration grows from the base on, with the payload at its tip.
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd velocity;  ///< of the frame's bodies, m/s
};

/// Parabolas through the places of the bodies over some tenths of a second.
std::vector<FrameMotion> motion_of(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                   const std::vector<trial::StaticFrame>& frames);

/// By how much the arm may be late, or its inputs, s: half of what the wall lags behind its moments by the
/// arm file, for a frame holds inputs that are half a sample old, and nobody knows which of the two is more.
double open_lag_s(const arm::Arm& arm);

}  // namespace softarm::identify
