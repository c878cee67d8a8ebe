// From what is hidden in the body (BodySpec) to the rod: private to the rig.
#pragma once

#include <vector>

#include "arm_cut.h"

namespace softarm::rig {

/// Fractions of the arm's length where what is hidden begins or ends.
std::vector<double> hidden_places(const Scenario& scenario);

/// Puts what is hidden into the ideal rod of the cut arm.
void hide_in_rod(const Scenario& scenario, const Cut& cut, RitzRodParams& params);

}  // namespace softarm::rig
