// What constants would be that the arm file's ranges stop.
#pragma once

#include <string>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

struct BeyondRange {
  std::string text;    ///< empty: no constant rests at an end
  bool helps = false;  ///< that trials are predicted better with a constant beyond the file's own range
};

/// In one or two sentences which of the arm's constants rest at an end of what the arm file allows because
/// the trials draw them beyond it, and, where the file's own range stops them, what they would be without it
/// and how much better trials are predicted then.
/// @param baseline the fit of the arm's constants alone
/// @param mean_m its mean error on trials left out
BeyondRange beyond_range(const JointModel& model, const Linearised& baseline, double mean_m,
                         const Options& options);

}  // namespace softarm::diagnose
