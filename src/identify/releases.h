// How an arm swings after a hand lets it go: frequency, damping and friction, found and tried out.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/trial/trial.h"

namespace softarm::identify {

/// Of the two lowest modes, one law for both; displacements are those of the outermost body.
struct SwingLaw {
  double stiffness_scale = 1.0;  ///< on the square of the angular frequency by the arm file
  double damping_ratio = 0.1;    ///< viscous, at that frequency
  double slip_share = 0.0;       ///< stiffness of the spring that slips over the other one; 0: no friction
  double slip_m = 0.0;           ///< by how much it is stretched before it slips
};

struct ReleaseError {
  std::string trial;
  bool fitted = false;
  double amplitude_m = 0.0;             ///< of the release: from where it was held to its rest
  double largest_m = 0.0;               ///< from the rest within the second that is predicted
  double linear_m = 0.0, slip_m = 0.0;  ///< rms distance of the outermost body, by either law
};

struct ReleaseFit {
  std::vector<double> mode_hz;  ///< of the arm file
  SwingLaw linear, slip;
  std::vector<ReleaseError> errors;
  std::vector<std::string> left_out;  ///< one line each
};

/// Fits both laws to every second release, and predicts a second of each from the first 0.3 s after the hand
/// let go.
/// @param trials of one release each, at inputs of 0; frames need a payload or the arm file a default
/// @throws std::invalid_argument with one line where they tell nothing
ReleaseFit fit_releases(const arm::Arm& arm, const std::vector<trial::Trial>& trials);

/// The same for people.
std::string describe(const ReleaseFit& fit);

}  // namespace softarm::identify
