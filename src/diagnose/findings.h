// What is named, how sure, what every arm has, and the verdict.
#pragma once

#include <Eigen/Core>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Fills ranking, effects, small departures and verdict.
/// @param covariance of the extended fit's unknowns, in scales
/// @param adequate nothing of a size that matters is left
/// @param d has the shares of what could be explained
void add_findings(JointModel& model, const Selection& selection, const Eigen::MatrixXd& covariance,
                  bool adequate, Diagnosis& d);

}  // namespace softarm::diagnose
