// Identification of an arm's constants with effects in the model.
#pragma once

#include <vector>

#include "model/effect.h"
#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

/// identify::identify() with the effects held at their values.
///
/// 1. What the effects do to every body of every frame, and how that changes with the constants, is worked
///    out at the constants known so far (memories included).
/// 2. The constants are fitted to what was measured, with that line beside the laws.
/// 3. Again from 1, until no constant moves by a share of its standard deviation: Newton's method for the
///    constants of the whole model. Standard deviations are those of that model.
/// Without effects it is identify::identify().
/// @throws as that
Result identify_extended(const arm::Arm& arm, const std::vector<model::Present>& effects,
                         const std::vector<trial::Trial>& trials, const Options& options = {},
                         const ProgressCallback& progress = {}, unsigned jobs = 0);

}  // namespace softarm::identify
