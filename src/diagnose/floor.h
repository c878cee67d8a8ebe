// What no model explains.
#pragma once

#include "joint_model.h"

namespace softarm::diagnose {

/// Mean square distances of bodies, by precision: by noise alone, and by what is not known of the motion.
struct Floor {
  double white_m2 = 0.0, motion_m2 = 0.0;
};

Floor floor_of(const JointModel& model);

}  // namespace softarm::diagnose
