// Where the catalogue leaves something that can be learnt: a law of it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

struct Law {
  Linearised fit;              ///< constants, effects and, last, the law's terms, fitted together
  Eigen::MatrixXd covariance;  ///< of the unknowns, in scales: the fit's own, inflated
  DiscoveredLaw said;
};

/// Terms that explain what the extended fit leaves are chosen by stability selection. They are a law where
/// true refits, with terms chosen anew from their own trials, predict other input sequences better, by a good
/// part of what a flexible model learns.
/// @param selection its extended fit is completed here
/// @param learnt share of the squared error on unseen trials that a flexible model learns
/// @param noise_floor_m rms distance of a body that noise alone makes
std::optional<Law> discover_law(JointModel& model, Selection& selection, double learnt, double noise_floor_m,
                                unsigned jobs);

}  // namespace softarm::diagnose
