// Constants that trials show far from where the arm file has them.
#pragma once

#include <string>
#include <vector>

#include "joint_model.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// In a few sentences which gains and stiffnesses are so far from the arm file's that the file may not be of
/// what was recorded: a chamber that is not connected, inputs in another order or unit, gravity from the
/// other side. Constants take all that up without a residual. Empty where none is.
std::string far_from_file(const JointModel& model, const std::vector<Shift>& shifts);

}  // namespace softarm::diagnose
