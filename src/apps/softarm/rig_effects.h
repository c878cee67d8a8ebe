// Effects of the catalogue in the virtual rig's own words.
#pragma once

#include <string>
#include <vector>

#include "model/effect.h"
#include "rig/hidden.h"
#include "softarm/arm/arm.h"

namespace softarm::app {

/// What a scenario has to hide so that the rig has the effect; the rig's own law where it has several forms,
/// the nearest. Nothing for an effect that acts by changing stiffnesses of the arm, see for_the_rig().
/// @throws std::invalid_argument, a line without a beginning, where the rig has no such thing
std::vector<rig::HiddenChoice> in_the_rig(const arm::Arm& arm, const model::Present& present);

/// The arm with what effects change of the stiffnesses of its segments, and with laws by which the rig's
/// forms of the others do what the catalogue's do.
arm::Arm for_the_rig(arm::Arm arm, const std::vector<model::Present>& effects);

}  // namespace softarm::app
