// What is left in residuals that noise would not leave.
#pragma once

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"
#include "unseen.h"

namespace softarm::diagnose {

/// Whiteness in time and along the arm by sign-flipping of stretches, which keeps what is correlated within
/// them; dependence on inputs by correlations of means over stretches.
Structure structure_of(const JointModel& model, const Linearised& at, const Unseen& unseen);

}  // namespace softarm::diagnose
