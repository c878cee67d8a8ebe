// What is left of residuals that noise of single bodies cannot make.
#pragma once

#include "joint_model.h"
#include "unseen.h"

namespace softarm::diagnose {

/// Of unseen trials, while the arm is calm: where it swings the model is known to first order only.
struct Leftover {
  /// Rms distance that neighbouring bodies share: the mean product of their residuals. Noise of single bodies
  /// has none, however slow it is. 0 where the mean is negative.
  double shared_m = 0.0;
  double shared_z = 0.0;  ///< the mean over its standard error, stretches of two seconds being independent
  /// What the worst body shows beyond the median of the bodies, rms distance; 0 with fewer than three.
  double lone_m = 0.0;
  double lone_z = 0.0;  ///< ... over its standard error, as shared_z: one swing is not a body that is off
  int lone_body = -1;
};
Leftover leftover(const JointModel& model, const Linearised& at, const Unseen& unseen);

}  // namespace softarm::diagnose
