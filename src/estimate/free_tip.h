// A way to a start for shapes near which the rod at its nominal stiffness has no equilibrium.
#pragma once

#include "problem.h"
#include "start.h"

namespace softarm::estimate {

/// Improves a start by fitting parameters and tip orientation together, with the clamped base as one residual
/// among the others. @return false if nothing near the measured shape was found
bool refine_with_free_tip(const Problem& problem, Start& start);

}  // namespace softarm::estimate
