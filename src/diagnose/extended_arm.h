// The arm's description with what was found in it.
#pragma once

#include <Eigen/Core>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// The arm with the constants of a fit, the effects that were known, and those of the fit with their standard
/// deviations and correlations.
/// @param covariance of the fit's unknowns, in scales
ExtendedArm extended_arm(const JointModel& model, const Linearised& fit, const Eigen::MatrixXd& covariance);

}  // namespace softarm::diagnose
