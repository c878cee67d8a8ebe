// The arm as the pieces of a rod: private to the rig.
#pragma once

#include <vector>

#include "laws.h"
#include "ritz_rod.h"
#include "scenario.h"

namespace softarm::rig {

/// A piece of the rod: a segment, or a part of it where something is within.
struct Part {
  std::size_t segment = 0;
  double begin = 0.0, share = 1.0;              ///< of the segment
  double first_fraction = 0.0, fraction = 1.0;  ///< its ends, of the arm's length
  int least_elements = 1;

  double middle() const { return 0.5 * (first_fraction + fraction); }
};

/// The arm cut where a payload hangs and where hidden things begin and end: there curvature, or its
/// derivatives, may jump.
struct Cut {
  std::vector<Part> parts;
  std::size_t payload_part = 0;  ///< at whose end the payload hangs

  /// The part that ends nearest to a fraction.
  std::size_t ending_at(double fraction) const;
};

/// Whether there is a jammed core that slips when the arm is bent by less than a turn.
bool core_slips(const Scenario& scenario);

Cut cut_arm(const Scenario& scenario);

/// The rod of the cut arm.
RitzRodParams rod_params(const Scenario& scenario, const Cut& cut);

/// What the actuation of the segments is to the pieces of the rod.
std::vector<PieceInputs> piece_inputs(const Cut& cut, const std::vector<Actuation>& actuation);

}  // namespace softarm::rig
