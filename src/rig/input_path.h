// From what is commanded to what acts in the arm: private to the rig.
#pragma once

#include <vector>

#include "play.h"
#include "softarm/rig/protocol.h"
#include "softarm/rig/scenario.h"

namespace softarm::rig {

/// Regulators, lines and tendons of a scenario. They remember: act() is asked in the order of time.
class InputPath {
 public:
  /// @param start commanded at t = 0, where everything has long settled
  InputPath(const Scenario& scenario, const Commands& start);

  /// What acts at a time, from what is commanded then.
  Commands act(const Commands& commanded, double t_s);

 private:
  std::vector<PlayHysteresis> pressure_plays_, tension_plays_, angle_plays_;
};

}  // namespace softarm::rig
