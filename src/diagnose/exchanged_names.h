// Bodies that have one another's names.
#pragma once

#include <string>
#include <vector>

#include "model/prepared_trial.h"
#include "softarm/arm/arm.h"

namespace softarm::diagnose {

/// In which trials rings stand along the arm in another order than the arm file says, and in which; empty:
/// nowhere. No effect of the arm, and nothing that is said beside it means anything.
std::string exchanged_names(const arm::Arm& arm, const std::vector<model::TrialData>& trials);

}  // namespace softarm::diagnose
