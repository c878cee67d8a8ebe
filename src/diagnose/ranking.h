// The whole catalogue, best first.
#pragma once

#include <vector>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Effects that were taken, their rivals, then the others of the last screen.
/// @param doubt what probabilities of those taken are multiplied by
std::vector<Candidate> ranking_of(const JointModel& model, const Selection& selection, double doubt);

}  // namespace softarm::diagnose
