// The arm as the pieces of a rod: private to the rig.
#pragma once

#include <vector>

#include "softarm/rig/ritz_rod.h"
#include "softarm/rig/scenario.h"

namespace softarm::rig {

/// A piece of the rod: a segment, or a part of it where the payload hangs within.
struct Part {
  std::size_t segment = 0;
  double share = 1.0;  ///< of the segment
};

/// The arm cut where a payload hangs, and the piece at whose end that is.
struct Cut {
  std::vector<Part> parts;
  std::size_t payload_part = 0;
};

Cut cut_arm(const Scenario& scenario);

/// The rod of the cut arm.
RitzRodParams rod_params(const Scenario& scenario, const Cut& cut);

}  // namespace softarm::rig
