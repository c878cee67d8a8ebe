// Scenarios in which the effects are hidden, and their usual sizes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig/hidden.h"
#include "rig/scenario.h"

namespace softarm::rig_accuracy {

/// Of shipped arms, tilted: pneumatic, with vacuum, with tendons, with a servo; the last in two segments,
/// too. Each shows within ten seconds whatever is done to it: inputs that cycle at two speeds (pressures at
/// 20 and 60 kPa/s) with holds, vacuum that comes and goes, a payload that is hung on. @throws std::exception
std::vector<rig::Scenario> hosts(const std::string& config, double seconds);

/// An effect in the middle of its usual range; where that range lies about 0, halfway to its upper end. Whole
/// numbers name things (a body, a chamber): their default or, without, the first ones. A wall is nearer, so
/// that the arm leans on it, and a ring is occluded early.
/// @param towards_deg azimuth for what has one: of what stands in the arm's way
rig::HiddenChoice usual_choice(const rig::HiddenEffect& effect, const std::string& form, double towards_deg);

/// @return nothing where the scenario does not take it
std::optional<rig::Scenario> hidden_in(rig::Scenario scenario, const rig::HiddenChoice& choice);

}  // namespace softarm::rig_accuracy
