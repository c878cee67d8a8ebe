// The parts of the table of hidden effects: private to the rig. A new effect is a line in one of them.
#pragma once

#include <vector>

#include "hidden.h"

namespace softarm::rig {

std::vector<HiddenEffect> body_effects();
std::vector<HiddenEffect> input_effects();
std::vector<HiddenEffect> sensor_effects();

}  // namespace softarm::rig
