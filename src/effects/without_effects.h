// Trials as an arm without its effects would have been recorded.
#pragma once

#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/effects/effect.h"
#include "softarm/identify/shape_error.h"

namespace softarm::effects {

/// Moves every body by what the effects do to it: by the difference of two predictions of the whole trial by
/// the arm's laws, without the effects and with them (memories and inputs included, in means over a tenth of
/// a second). Frames that cannot be predicted are left out.
std::vector<identify::Trial> without_effects(const Arm& arm, const std::vector<Present>& effects,
                                             const std::vector<identify::Trial>& trials, unsigned jobs);

}  // namespace softarm::effects
