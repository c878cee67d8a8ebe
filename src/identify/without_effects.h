// Trials as an arm without its effects would have been recorded.
#pragma once

#include <vector>

#include "model/effect.h"
#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"

namespace softarm::identify {

/// Moves every body by what the effects do to it: by the difference of two predictions of the whole trial by
/// the arm's laws, without the effects and with them (memories and inputs included, in means over a tenth of
/// a second). Frames that cannot be predicted are left out.
std::vector<trial::Trial> without_effects(const arm::Arm& arm, const std::vector<model::Present>& effects,
                                          const std::vector<trial::Trial>& trials, unsigned jobs);

}  // namespace softarm::identify
