// What the virtual rig does with an arm file that comes without a scenario.
#pragma once

#include <yaml-cpp/yaml.h>

#include "softarm/arm/arm.h"

namespace softarm::app {

/// All inputs move smoothly at random, as far as they bend the arm well and stretch it little; a weight that
/// it can carry is hung on and taken off; a jamming core is evacuated now and then. A measured base hangs, or
/// is horizontal where nothing bends the arm but its weight. Endless, with the noise of the arm file.
/// @returns the document, but for the key `arm`
YAML::Node usual_scenario(const arm::Arm& arm);

}  // namespace softarm::app
