// Stiffness along a segment.
#pragma once

#include <vector>

#include "softarm/arm/arm.h"

namespace softarm::arm {

/// Factor on a segment's EI and GJ at a fraction of its length, 0 ... 1: straight between knots, constant
/// beyond them; 1 without any.
double stiffness_factor(const std::vector<StiffnessKnot>& profile, double fraction);

}  // namespace softarm::arm
