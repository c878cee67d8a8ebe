// Trials and an arm's description to what the description leaves out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/diagnose/diagnosis.h"
#include "softarm/export.h"
#include "softarm/identify/shape_error.h"
#include "softarm/model/present.h"

namespace softarm::diagnose {

struct Options {
  double block_s = 0.1;  ///< over which frames are averaged before they are compared
  int most_effects = 4;  ///< in one verdict
  int refits = 4;        ///< of the screen's best, per round
  /// Patterns of constants that keep the arm file's value, and of those that have one value in all segments,
  /// as identify::matching() and identify::tie_constants() have them.
  std::vector<std::string> held, tied;
  unsigned jobs = 0;  ///< threads; 0: one per core
  /// Effects of the arm file: in the baseline and in everything else, at their values.
  std::vector<model::Present> known;
};

/// Called with the share of the work that is done, 0 ... 1, and what is being done.
using Progress = std::function<void(double, const std::string&)>;

/// 1. Means over short times; white noise from their scatter; what a hand or a swing disturbs is left out.
/// 2. Baseline: the arm's constants (gains, stiffness and length laws), one value for all trials, and the
///    inertia of its known masses.
/// 3. Score screen of the catalogue: signatures orthogonal to all constants, sums over stretches of two
///    seconds, so that correlated residuals widen the intervals.
/// 4. The best are refitted together with the constants; one is taken into the model where it lowers the
///    error on trials left out, and again from 3; at the end each must still be worth its place.
/// 5. A Gaussian process over inputs, their speeds and past, payload, attitude and time says what could be
///    explained at all, before and after.
/// 6. Verdict; a name only where no rival does as well.
/// @throws identify::IdentifyError where the trials cannot be used
/// @throws std::invalid_argument for patterns that match nothing
SOFTARM_EXPORT Diagnosis diagnose(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                  const Options& options = {}, const Progress& progress = {});

}  // namespace softarm::diagnose
