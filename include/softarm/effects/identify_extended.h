// Identification of an arm's constants with effects in the model.
#pragma once

#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/effects/effect.h"
#include "softarm/identify/identify.h"

namespace softarm::effects {

/// identify::identify() with the effects held at their values.
///
/// 1. What the effects do to every body of every frame, by the constants known so far, is taken from what was
///    measured (differences of whole predictions, memories included).
/// 2. The constants are identified from that.
/// 3. Again from 1, until no constant moves by a share of its standard deviation: there the laws with the
///    effects fit what was measured. Standard deviations are those of the laws about that.
/// Without effects it is identify::identify().
/// @throws as that
identify::Result identify_extended(const Arm& arm, const std::vector<Present>& effects,
                                   const std::vector<identify::Trial>& trials,
                                   const identify::Options& options = {},
                                   const identify::ProgressCallback& progress = {}, unsigned jobs = 0);

}  // namespace softarm::effects
