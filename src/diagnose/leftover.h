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
  /// What the worst body shows beyond the next one, rms distance; 0 with fewer than three.
  double lone_m = 0.0;
  int lone_body = -1;
};
Leftover leftover(const JointModel& model, const Linearised& at, const Unseen& unseen);

}  // namespace softarm::diagnose
