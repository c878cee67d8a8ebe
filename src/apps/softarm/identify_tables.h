// What `softarm identify --plot` writes.
#pragma once

#include <string>
#include <vector>

#include "softarm/identify/identify.h"

namespace softarm::app {

/// One row per chosen frame and body: trial, stamp, payload, inputs, measured and predicted places before and
/// after, all in the rod's base frame (m). The same result gives the same text.
std::string shapes_csv(const arm::Arm& before, const identify::Result& result,
                       const std::vector<trial::Trial>& trials, const identify::FrameChoice& choice);

/// One row per constant: name, unit, initial, value, sd, scale, determined.
std::string constants_csv(const identify::Result& result);

}  // namespace softarm::app
